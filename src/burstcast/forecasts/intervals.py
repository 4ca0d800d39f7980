"""Intervals of ratios by resampling whole series."""

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.resampling import percentile_interval
from burstcast.forecasts.classification import ratio


def ratio_with_interval(
    numerator: FloatArray, denominator: FloatArray, weights: IntArray, confidence: float
) -> tuple[float, float, float]:
    """Ratio of two sums over series ``(series,)``, with its interval."""
    value = ratio(numerator.sum(), denominator.sum())
    factors = weights.astype(np.float64)
    samples = ratio(factors @ numerator, factors @ denominator)
    return float(value), *percentile_interval(samples, confidence)
