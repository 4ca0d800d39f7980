"""The leading Lyapunov exponent from series, by the divergence of neighbouring states.

Source: Rosenstein, Collins & De Luca, "A practical method for calculating largest Lyapunov
exponents from small data sets", Physica D 65 (1993). The logarithm of the distance of states to
their nearest neighbours, averaged over many, grows linearly at first, by the leading exponent.

It is an estimate with an error that its interval does not know: neighbours in a finite number of
series are not close, the more so the more dimensions the attractor has, so that little growth is
left before distances saturate; and it takes time until they point in the direction that grows
fastest. The mean logarithm is therefore fitted over a part of its way from where it begins to where
it saturates, `FITTED`, which leaves both ends out. These shares were chosen with the Lorenz-63
system and the shear flow at Re = 400 at hand. What came of them, beside exponents of the equations
(of the shear flow those that the paper has):

=============================================  ========  ========  =====
series                                         estimate  known     error
=============================================  ========  ========  =====
Lorenz-63, ten series of 80 time units         0.893     0.906     - 1 %
the same with 1 % of noise                     0.873     0.906     - 4 %
its component z alone (in delays)              0.857     0.906     - 5 %
shear flow, Re = 400, ten series of 4000       0.0152    0.0163    - 7 %
shear flow, Re = 800                           0.0131    0.0126    + 4 %
shear flow, Re = 1000                          0.0129    0.0121    + 7 %
Roessler's system                              0.059     0.071     - 18 %
kinetic energy of the shear flow alone         0.058     0.0163    + 250 %
=============================================  ========  ========  =====

One component of a flow of many dimensions is not enough. As the unit of time, which is all that it
is used for here, a tenth matters little.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from burstcast.arrays import FloatArray, IntArray, float_array
from burstcast.statistics.resampling import bootstrap_weights, percentile_interval

FITTED = (0.15, 0.45)
"""Part of its way to saturation over which the mean logarithm of the distances is fitted."""

REFERENCES = 4000
"""Most states whose neighbours are followed."""

DELAYS = {1: 5, 2: 3}
"""Copies, each a correlation time later, that stand for a state of so many components."""

_RANDOM_PAIRS = 20000
_FIRST_STEPS = 16
_MOST_CANDIDATES = 1024


@dataclass(frozen=True)
class NeighbourDivergence:
    """Divergence of neighbouring states.

    Attributes
    ----------
    exponent, low, high
        The leading exponent in inverse time units, with its interval over series.
    log_distance
        Mean logarithm of the distance after 0, 1, 2, ... steps, in standard deviations of the
        components.
    fitted
        First and last step of the fit.
    theiler_window
        States of one series are no neighbours if they are not further apart than this, in steps.
    """

    exponent: float
    low: float
    high: float
    log_distance: FloatArray
    fitted: tuple[int, int]
    theiler_window: int


def neighbour_divergence(
    series: FloatArray,
    sampling_interval: float,
    generator: np.random.Generator,
    *,
    resamples: int,
    confidence: float,
) -> NeighbourDivergence:
    """Estimate the leading Lyapunov exponent of series.

    The Theiler window is the correlation time: the lag at which the autocorrelation has fallen to
    1 / e.

    Parameters
    ----------
    series
        ``(series, time, component)``; no component is constant.
    sampling_interval
        Time between two steps, in time units.
    generator
        Chooses the states that are followed, and the bootstrap samples.
    resamples, confidence
        Of the interval, by a bootstrap over the series that the states lie in.

    Raises
    ------
    ValueError
        If distances do not grow, or the series are too short to see it.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.statistics.neighbour_divergence import neighbour_divergence
    >>> from burstcast.systems.integration import integrate
    >>> from burstcast.systems.lorenz63 import Lorenz63
    >>> generator = np.random.default_rng(0)
    >>> start = np.array([[1.0], [1.0], [20.0]]) + generator.normal(size=(3, 10))
    >>> series = integrate(Lorenz63(), start, 0.01, 6000, stride=2)[1000:].transpose(2, 0, 1)
    >>> found = neighbour_divergence(series, 0.02, generator, resamples=50, confidence=0.95)
    >>> bool(abs(found.exponent - 0.906) < 0.2)
    True
    """
    series = float_array(series, "the series")
    states = series / series.std(axis=(0, 1))
    window = correlation_steps(states)
    states = _embedded(states, DELAYS.get(states.shape[2], 1), window)
    saturated = _saturation(states, generator)
    steps, least = _FIRST_STEPS, states.shape[1] // 3
    while True:
        followed = _Neighbours.of(states, min(steps, least), window, generator)
        mean = followed.log_distance.mean(axis=0)
        if saturated > mean[0] and mean.max() > _level(mean[0], saturated, FITTED[1]):
            break
        if steps >= least:
            raise ValueError(
                "no exponent can be seen in these series: neighbouring states do not part within "
                f"{least} steps, a third of a series"
            )
        steps *= 2
    levels = [_level(mean[0], saturated, share) for share in FITTED]
    first, last = (int(np.argmax(mean > level)) for level in levels)
    last = max(last, first + 1)
    time = sampling_interval * np.arange(first, last + 1)
    # the slope of a sum of curves is the sum of their slopes: the bootstrap adds up slopes
    centred = (time - time.mean()) / np.square(time - time.mean()).sum()
    slopes = followed.log_distance[:, first : last + 1] @ centred
    count = len(states)
    by_series = np.bincount(followed.series, weights=slopes, minlength=count)
    number = np.bincount(followed.series, minlength=count)
    weights = bootstrap_weights(count, resamples, generator)
    with np.errstate(invalid="ignore", divide="ignore"):
        samples = (weights @ by_series) / (weights @ number)
    low, high = percentile_interval(samples, confidence)
    return NeighbourDivergence(float(slopes.mean()), low, high, mean, (first, last), window)


def correlation_steps(series: FloatArray) -> int:
    """Steps until the autocorrelation of series ``(series, time, component)`` is below 1 / e.

    A quarter of the series if it is not before that.
    """
    departures = series - series.mean(axis=(0, 1))
    variance = np.square(departures).mean()
    most = int(series.shape[1] // 4)
    for lag in range(1, most):
        if (departures[:, lag:] * departures[:, :-lag]).mean() < variance / np.e:
            return lag
    return max(1, most)


@dataclass(frozen=True)
class _Neighbours:
    """Pairs of neighbours: the series of the first of each, and how their distance went on."""

    series: IntArray
    log_distance: FloatArray

    @classmethod
    def of(
        cls, states: FloatArray, steps: int, window: int, generator: np.random.Generator
    ) -> "_Neighbours":
        """Follow the nearest neighbours of states for some steps."""
        # both are followed to the end: the mean is over the same pairs at all times
        starts = states.shape[1] - steps
        candidates = states[:, :starts].reshape(-1, states.shape[2])
        tree = cKDTree(candidates)
        chosen = generator.choice(
            len(candidates), min(REFERENCES, len(candidates)), replace=False, shuffle=False
        )
        chosen.sort()
        neighbour = np.full(len(chosen), -1)
        waiting, count = np.arange(len(chosen)), 2
        while len(waiting) and count <= min(_MOST_CANDIDATES, len(candidates)):
            found = np.asarray(tree.query(candidates[chosen[waiting]], k=count)[1])
            at = chosen[waiting][:, np.newaxis] % starts
            others, later = np.divmod(found, starts)
            distinct = (others != chosen[waiting][:, np.newaxis] // starts) | (
                np.abs(later - at) > window
            )
            has = distinct.any(axis=1)
            neighbour[waiting[has]] = found[has, distinct[has].argmax(axis=1)]
            waiting, count = waiting[~has], 4 * count
        known = neighbour >= 0
        if not known.any():
            raise ValueError("no state has a neighbour: the series are too short")
        series, step = np.divmod(chosen[known], starts)
        other_series, other_step = np.divmod(neighbour[known], starts)
        distance = np.empty((len(series), steps + 1))
        for ahead in range(steps + 1):
            apart = states[series, step + ahead] - states[other_series, other_step + ahead]
            distance[:, ahead] = np.linalg.norm(apart, axis=1)
        # states that were measured twice have no distance at first
        apart_at_all = (distance > 0).all(axis=1)
        return cls(series[apart_at_all], np.log(distance[apart_at_all]))


def _level(first: float, saturated: float, share: float) -> float:
    return first + share * (saturated - first)


def _saturation(states: FloatArray, generator: np.random.Generator) -> float:
    """Mean logarithm of the distance of two states at random."""
    flat = states.reshape(-1, states.shape[2])
    one, other = flat[generator.integers(len(flat), size=(2, _RANDOM_PAIRS))]
    distance = np.linalg.norm(one - other, axis=1)
    return float(np.log(distance[distance > 0]).mean())


def _embedded(states: FloatArray, copies: int, lag: int) -> FloatArray:
    """Delay coordinates of series, ``(series, time, copies * component)``."""
    length = states.shape[1] - (copies - 1) * lag
    if length < 1:
        raise ValueError("the series are shorter than their own correlation time")
    parts = [states[:, copy * lag : copy * lag + length] for copy in range(copies)]
    return np.concatenate(parts, axis=2)
