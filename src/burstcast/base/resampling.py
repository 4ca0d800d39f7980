"""Bootstrap, jackknife and intervals over independent units: test series, events, trajectories.

What shares a series, an event or a run is drawn together; what is compared is drawn alike.
"""

from dataclasses import dataclass

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray


def bootstrap_weights(count: int, resamples: int, generator: np.random.Generator) -> IntArray:
    """Number of draws of each of ``count`` units in each bootstrap sample, ``(resamples, ...)``."""
    return generator.multinomial(count, np.full(count, 1 / count), size=resamples)


def percentile_interval(samples: FloatArray, confidence: float) -> tuple[float, float]:
    """Ends between which a share of the finite bootstrap samples ``(resamples,)`` lies."""
    defined = samples[np.isfinite(samples)]
    if not defined.size:
        return float("nan"), float("nan")
    tail = (1 - confidence) / 2
    low, high = np.quantile(defined, [tail, 1 - tail])
    return float(low), float(high)


def loss_interval(
    loss: float, left_out: FloatArray, one_more: float, confidence: float
) -> tuple[float, float]:
    """Interval of a loss, which cannot be negative, and which few units may carry.

    The loss is taken for a weighted sum of Poisson counts, with the variance of a jackknife; its
    upper end allows for one more unit with the largest contribution (Fay & Feuer, Statistics in
    Medicine 16, 1997). The percentile bootstrap is too narrow there: it draws no error that the
    sample has not. The variance is larger by the square of Student's over the normal quantile.

    ``left_out``: The loss without each unit, ``(units,)``. ``one_more``: Loss with one more error.
    Ends are NaN for fewer than two units, or where the loss is undefined without one of them.

    Examples
    --------
    >>> low, high = loss_interval(0.0, np.zeros(20), 0.01, 0.95)
    >>> low, round(high, 4)  # -log(0.025) further errors where none was seen
    (0.0, 0.0369)
    """
    from scipy.stats import gamma, norm  # jobs that have no interval start without them
    from scipy.stats import t as student

    units = len(left_out)
    if units < 2 or not np.isfinite([loss, one_more, *left_out]).all():
        return float("nan"), float("nan")
    level = (1 + confidence) / 2
    widened = float(student.ppf(level, units - 1) / norm.ppf(level)) ** 2
    variance = widened * (units - 1) * float(left_out.var())
    low = gamma.ppf(1 - level, loss**2 / variance, scale=variance / loss) if variance > 0 else loss
    largest = max(one_more - loss, loss - float(left_out.min()))
    more, beyond = loss + largest, variance + largest**2
    high = gamma.ppf(level, more**2 / beyond, scale=beyond / more) if beyond > 0 else loss
    return float(low), float(high)


@dataclass(frozen=True)
class Estimate:
    """A mean over independent trajectories with its confidence interval."""

    #: mean, low, high: arrays of the shape of the averaged values, without the axis of trajectories
    mean: FloatArray
    low: FloatArray
    high: FloatArray


def mean_with_interval(per_series: FloatArray, confidence: float = 0.95) -> Estimate:
    """Mean over the first axis, of trajectories, and its confidence interval (Student's t)."""
    from scipy.special import stdtrit  # jobs that have no interval start without it

    count = len(per_series)
    if count < 2:
        raise ValueError(f"a confidence interval needs at least two trajectories, not {count}")
    if not 0.0 < confidence < 1.0:
        raise ValueError(f"the confidence must be between 0 and 1, not {confidence}")
    mean = np.asarray(per_series.mean(axis=0))
    error = np.asarray(per_series.std(axis=0, ddof=1) / np.sqrt(count))
    margin = stdtrit(count - 1, 0.5 + 0.5 * confidence) * error
    return Estimate(mean, low=np.asarray(mean - margin), high=np.asarray(mean + margin))
