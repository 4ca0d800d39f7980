"""The noise of observed series, estimated from them alone.

A smooth trajectory that is sampled finely enough leaves almost nothing in a high difference, and
white noise does: the difference of order p of independent numbers of variance s^2 has the variance
(2 p choose p) s^2. The estimator is the difference-based one of nonparametric regression (Hall, Kay
& Titterington, Biometrika 77, 1990), with the ordinary differences.
"""

import math

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.series_lengths import samples_of

_ORDER = 8
"""Order of the differences: an oscillation of eight samples is damped to a thousandth of itself."""


def observation_noise(series: FloatArray, level: float | None) -> FloatArray:
    """Standard deviation of the noise in each component of observed series.

    ``level``: In standard deviations of each component; None: it is estimated (`estimate_noise`).
    In the units of the components, ``(dimension,)``.
    """
    if level is None:
        return estimate_noise(series)
    scale: FloatArray = samples_of(series).std(axis=0)
    return level * scale


def estimate_noise(series: FloatArray) -> FloatArray:
    """Standard deviation of the white noise in each component of observed series.

    Where the sampling is too coarse for the dynamics, it is too large, never too small: what the
    trajectory itself leaves in the differences counts as noise.

    In the units of the components, ``(dimension,)``.
    """
    if series.shape[1] <= _ORDER:
        raise ValueError(
            f"the noise is estimated from differences of order {_ORDER}, which series of "
            f"{series.shape[1]} samples do not have"
        )
    differences = np.diff(series, n=_ORDER, axis=1)
    squares: FloatArray = samples_of(np.square(differences)).mean(axis=0)
    variance = squares / math.comb(2 * _ORDER, _ORDER)
    return np.sqrt(variance)
