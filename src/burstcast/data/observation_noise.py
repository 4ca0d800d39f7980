"""The noise of observed series, estimated from them alone.

A smooth trajectory that is sampled finely enough leaves almost nothing in a high difference, and
white noise does: the difference of order p of independent numbers of variance s^2 has the variance
(2 p choose p) s^2. The estimator is the difference-based one of nonparametric regression (Hall, Kay
& Titterington, Biometrika 77, 1990), with the ordinary differences.

Differences of Gaussian noise are Gaussian. Short spikes of a trajectory leave a few much larger
ones, which the mean of the squares is made of and the median hardly notices: where the two
contradict each other, the median counts (Rousseeuw & Croux, Journal of the American Statistical
Association 88, 1993).
"""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.series_lengths import samples_of

_ORDER = 8
"""Order of the differences: an oscillation of eight samples is damped to a thousandth of itself."""
_FURTHER_ORDER = 12
"""Order that must find the same noise: trajectories leave less in it, white noise does not."""
_MEDIAN_OF_GAUSSIAN = 0.6744897501960817
"""Median absolute value of a Gaussian number of unit variance."""
_HEAVY_TAILS = 1.1
"""Root mean square over median-based scale beyond which differences are not Gaussian. Of the
paper's training series, or of a third of them, the ratio is below 1.05."""
_ORDERS_DISAGREE = 1.5
"""Ratio of the estimates of the two orders beyond which the trajectory is taken for noise."""
_SMALL_NOISE = 0.002
"""Noise that does no harm whatever it is, in standard deviations of a component."""


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

    It is the root mean square of the differences, or, where large ones are too frequent for
    Gaussian noise, the scale that their median gives. Where the sampling is too coarse for the
    dynamics most of the time, it is too large, never too small: what the trajectory itself leaves
    in the differences counts as noise (`coarse_sampling`).

    In the units of the components, ``(dimension,)``.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.data.observation_noise import estimate_noise
    >>> noise = np.random.default_rng(0).normal(size=(1, 4000, 1))
    >>> smooth = np.sin(0.05 * np.arange(4000))[np.newaxis, :, np.newaxis]
    >>> estimate_noise(smooth + 0.1 * noise).round(2).tolist()
    [0.1]
    """
    if series.shape[1] <= _ORDER:
        raise ValueError(
            f"the noise is estimated from differences of order {_ORDER}, which series of "
            f"{series.shape[1]} samples do not have"
        )
    return _robust(series, _ORDER)


def coarse_sampling(series: FloatArray, names: Sequence[str]) -> Iterator[str]:
    """A sentence about components whose sampling is too coarse to estimate their noise.

    White noise is the same in differences of any order; of a trajectory, or of noise that is
    correlated in time, the higher order holds less. ``names``: Of the components.
    """
    if series.shape[1] <= _FURTHER_ORDER:
        return
    spread = samples_of(series).std(axis=0)
    first, further = estimate_noise(series), _robust(series, _FURTHER_ORDER)
    harmful = (first > _SMALL_NOISE * spread) & (first > _ORDERS_DISAGREE * further)
    if harmful.any():
        listed = ", ".join(
            f"{names[component]} {first[component] / spread[component]:.2g} or "
            f"{further[component] / spread[component]:.2g}"
            for component in np.flatnonzero(harmful).tolist()
        )
        yield (
            f"the sampling is too coarse to tell the noise from the trajectory: differences of "
            f"order {_ORDER} and {_FURTHER_ORDER} contradict each other (noise in standard "
            f"deviations: {listed}); sample more finely, or give the noise (option noise)"
        )


def spiky_components(series: FloatArray, names: Sequence[str]) -> list[str]:
    """Names of components whose spikes are shorter than a few samples: the median was needed."""
    if series.shape[1] <= _ORDER:
        return []
    mean, median = _scales(series, _ORDER)
    spread = samples_of(series).std(axis=0)
    spiky = (mean > 2 * median) & (mean > 0.01 * spread)
    return [names[component] for component in np.flatnonzero(spiky).tolist()]


def _robust(series: FloatArray, order: int) -> FloatArray:
    """Noise in each component from differences of one order, ``(dimension,)``."""
    mean, median = _scales(series, order)
    return np.where(mean > _HEAVY_TAILS * median, median, mean)


def _scales(series: FloatArray, order: int) -> tuple[FloatArray, FloatArray]:
    """Noise by the mean of the squares of differences, and by their median, ``(dimension,)``."""
    differences = samples_of(np.diff(series, n=order, axis=1))
    squares: FloatArray = np.square(differences).mean(axis=0)
    # where a sensor stands still, a difference of zero tells nothing
    moving = np.where(differences == 0, np.nan, np.abs(differences))
    still = np.isnan(moving).all(axis=0)
    size: FloatArray = np.nanmedian(np.where(still, 0.0, moving), axis=0)
    factor = math.comb(2 * order, order)
    return np.sqrt(squares / factor), size / _MEDIAN_OF_GAUSSIAN / math.sqrt(factor)
