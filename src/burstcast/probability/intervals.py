"""Intervals of scores, and of differences between forecasters, by resampling whole series."""

import numpy as np

from burstcast.arrays import FloatArray, IntArray
from burstcast.forecast.classification import ratio


def series_weights(series: int, resamples: int, generator: np.random.Generator) -> IntArray:
    """How often each series is drawn in each bootstrap sample, ``(resamples, series)``.

    Forecasters that are compared are given the same weights: what the samples share cancels.
    """
    return generator.multinomial(series, np.full(series, 1 / series), size=resamples)


def percentile_interval(samples: FloatArray, confidence: float) -> tuple[float, float]:
    """Ends between which a share of the samples lies; NaN where none is defined.

    Parameters
    ----------
    samples
        ``(resamples,)``; those that are not finite are left out.
    confidence
        Share inside the interval, in (0, 1).
    """
    defined = samples[np.isfinite(samples)]
    if not defined.size:
        return np.nan, np.nan
    tail = (1 - confidence) / 2
    low, high = np.quantile(defined, [tail, 1 - tail])
    return float(low), float(high)


def ratio_with_interval(
    numerator: FloatArray, denominator: FloatArray, weights: IntArray, confidence: float
) -> tuple[float, float, float]:
    """Ratio of two sums over series, with its interval.

    Parameters
    ----------
    numerator, denominator
        By series, ``(series,)``.
    weights
        Of the series in each resample (`series_weights`).
    confidence
        Share inside the interval, in (0, 1).

    Returns
    -------
    Ratio and both ends; NaN where they are not defined.
    """
    value = ratio(numerator.sum(), denominator.sum())
    factors = weights.astype(np.float64)
    samples = ratio(factors @ numerator, factors @ denominator)
    return float(value), *percentile_interval(samples, confidence)
