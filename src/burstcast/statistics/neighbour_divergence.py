"""The leading Lyapunov exponent from series, by the divergence of neighbouring states.

Source: Rosenstein, Collins & De Luca, "A practical method for calculating largest Lyapunov
exponents from small data sets", Physica D 65 (1993). The logarithm of the distance of states to
their nearest neighbours, averaged over many, grows linearly at first, by the leading exponent.

Three things hide that growth in series of finite length:

* Neighbours are apart along the flow, too, which does not grow. Distances are taken across the
  flow.
* Distances saturate, and noise is a floor below them. Growth that saturates above a floor is
  fitted to the mean logarithm, by two laws (`POWERS`) and up to two levels (`FITTED`); the estimate
  is the mean of the four.
* Neighbours take time until they point in the direction that grows fastest. This is not corrected.

Neighbouring states of noise part as well. An exponent is given only where neighbours stay together
for longer than those of surrogates: noise with the spectra, cross-spectra and distributions of the
series (Theiler et al., "Testing for nonlinearity in time series: the method of surrogate data",
Physica D 58 (1992)). In trials the mean logarithm of the distance was 10 to 270 standard deviations
of the surrogates below their mean in nine sets of chaotic series, and at most 4 in 17 sets of
noise.

The interval holds the scatter over series, the differences of the four fits, and the remaining
error, `METHOD_ERROR`. Estimates from ten series of 4000 samples, some 25 to 80 Lyapunov times each
(the pair: 6000 and 84), and exponents of the equations:

===============================================  ========  ================  ==========  ======
series                                           estimate  interval (95 %)   1 % noise   true
===============================================  ========  ================  ==========  ======
four species (Lotka-Volterra; Vano et al. 2006)  0.0194    0.0155 to 0.0234  0.0165      0.0204
bursting neuron (Hindmarsh-Rose)                 0.0147    0.0115 to 0.0177  0.0116      0.0133
pair of FitzHugh-Nagumo units                    0.0073    0.0058 to 0.0088              0.0070
shear flow, Re = 400                             0.0154    0.0109 to 0.0206  0.0157      0.0163
shear flow, Re = 800                             0.0124    0.0087 to 0.0168  0.0127      0.0126
shear flow, Re = 1000                            0.0133    0.0091 to 0.0185  0.0138      0.0121
Lorenz                                           0.963     0.767 to 1.16     0.886       0.906
Roessler                                         0.0703    0.0558 to 0.0853  0.0561      0.0714
Halvorsen                                        0.871     0.695 to 1.04     0.806       0.790
Sprott B                                         0.222     0.176 to 0.268    0.202       0.210
Sprott C                                         0.168     0.132 to 0.205    0.157       0.163
Chen                                             2.04      1.62 to 2.46      1.82        2.03
Thomas                                           0.0643    0.0493 to 0.0801  0.0667      0.0349
===============================================  ========  ================  ==========  ======

The interval misses Thomas' system, in which distances of any size grow faster than infinitesimal
ones. One component of a flow of many dimensions is not enough: the kinetic energy of the shear flow
alone yields 3.5 times the exponent.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import scipy

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.resampling import bootstrap_weights, percentile_interval
from burstcast.base.series_lengths import padded, samples_of, series_lengths, without_padding
from burstcast.data.series_layout import labelled_series

FITTED = (0.5, 0.65)
"""Parts of its way to saturation over which the mean logarithm of the distances is fitted."""

POWERS = (1, 2)
"""Laws of saturation: of growth that slows down with the distance, or with its square."""

METHOD_ERROR = 0.1
"""Standard deviation of the relative error beside what series and fits differ by: the root mean
square of 26 errors, of the systems above but for Thomas' and the pair, with noise and without."""

REFERENCES = 4000
"""Most states whose neighbours are followed."""

SURROGATES = 6
"""Surrogates of each kind, in which the neighbours of `SURROGATE_REFERENCES` states are
followed."""

SURROGATE_REFERENCES = 1000

LEAST_DEPARTURE = 7.0
"""Standard deviations of the surrogates by which neighbours must be closer than theirs."""

DELAYS = {1: 5, 2: 3}
"""Copies, each a correlation time later, that stand for a state of so many components."""

_METHOD = "divergence of nearest neighbours in the training series"
_RANDOM_PAIRS = 20000
_FIRST_STEPS = 16
_MOST_CANDIDATES = 1024
_LEAST_STEPS = 4
_FAINT = 20.0


class NoExponentError(ValueError):
    """Series that show no Lyapunov exponent: neighbours do not part, or part as those of noise."""

    def record(self) -> dict[str, Any]:
        """Contents of a file of Lyapunov exponents without an estimate."""
        none = dict.fromkeys(("mean", "low", "high"))
        return {"leading": none, "method": _METHOD, "no_estimate": str(self)}


@dataclass(frozen=True)
class NeighbourDivergence:
    """Divergence of neighbouring states."""

    #: exponent, low, high: the leading exponent in inverse time units, with an interval for all
    #: errors known of
    exponent: float
    low: float
    high: float
    #: mean logarithm of the distance across the flow after 0, 1, 2, ... steps, in standard
    #: deviations of the components.
    log_distance: FloatArray
    fitted: tuple[int, int]  #: first and last step of the longest fit
    #: states of one series are no neighbours if they are not further apart than this, in steps
    theiler_window: int

    def record(self) -> dict[str, Any]:
        """Lists and numbers that a file of Lyapunov exponents has."""
        return {
            "leading": {"mean": self.exponent, "low": self.low, "high": self.high},
            "method": _METHOD,
            "log_distance": self.log_distance.tolist(),
            "fitted_steps": list(self.fitted),
            "theiler_window": self.theiler_window,
        }


def neighbour_divergence(
    series: Any,
    sampling_interval: float,
    generator: np.random.Generator,
    *,
    resamples: int,
    confidence: float,
) -> NeighbourDivergence:
    """Estimate the leading Lyapunov exponent of series.

    The Theiler window is the correlation time: the lag at which the autocorrelation has fallen to
    1 / e.

    ``series``: ``(series, time, component)`` (`burstcast.data.series_layout`), or a list of series
    of unequal lengths; no component is constant. ``sampling_interval``: Time between two steps, in
    time units. ``generator``: Chooses the states that are followed, and the bootstrap samples.
    ``resamples``, ``confidence``: Number of resamples and confidence level of the interval: of a
    bootstrap over the series that the states lie in, for each fit, with the error of the method.

    Raises NoExponentError if distances do not grow, if they grow as in noise, or if the series are
    too short to see it.

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
    if not 0 < sampling_interval < np.inf:
        raise ValueError(f"the sampling interval must be positive, not {sampling_interval}")
    if resamples < 1:
        raise ValueError(f"resamples must be 1 at least, not {resamples}")
    if not 0 < confidence < 1:
        raise ValueError(f"confidence must lie between 0 and 1, not be {confidence}")
    scaled = _scaled(labelled_series(series).states)
    window = correlation_steps(scaled)
    states = _embedded(scaled, DELAYS.get(scaled.shape[2], 1), window)
    curves = _curves(states, window, generator)
    mean = curves.log_distance.mean(axis=0)
    fits = [
        _growth(mean[: max(end, _LEAST_STEPS) + 1], curves.saturated, power)
        for end in curves.ends
        for power in POWERS
    ]
    rates = _resampled_rates(
        curves, mean, fits, bootstrap_weights(len(states), resamples, generator)
    )
    error = 1.0 + METHOD_ERROR * generator.standard_normal((len(fits), resamples))
    low, high = percentile_interval(np.ravel(rates * error) / sampling_interval, confidence)
    exponent = float(np.mean([rate for rate, _ in fits])) / sampling_interval
    if not low > 0:
        raise NoExponentError(
            f"the exponent of these series, {exponent:.3g} ({low:.3g} to {high:.3g}), cannot be "
            "told from 0"
        )
    last = max(curves.ends)
    departure = _departure_from_noise(scaled, mean[: last + 1], window, generator)
    if not departure > LEAST_DEPARTURE:
        raise NoExponentError(
            "no exponent can be seen in these series: neighbouring states part as fast as those of "
            "noise with the same spectra"
        )
    return NeighbourDivergence(exponent, low, high, mean, (1, last), window)


def _scaled(states: FloatArray) -> FloatArray:
    """Series divided by the standard deviation of each component."""
    unequal = series_lengths(states) is not None
    spread = samples_of(states).std(axis=0) if unequal else states.std(axis=(0, 1))
    if not (spread > 0).all():
        raise ValueError("no component of the series may be constant")
    scaled: FloatArray = states / spread
    return scaled


class _Curves(NamedTuple):
    """How pairs of neighbours part."""

    series_of: IntArray  #: the series of each pair, ``(pairs,)``
    log_distance: FloatArray  #: logarithm of the distance, ``(pairs, steps)``
    saturated: float  #: of states that have nothing to do with each other
    ends: list[int]  #: steps at which the mean has grown by each share of `FITTED`


def _curves(states: FloatArray, window: int, generator: np.random.Generator) -> _Curves:
    """Follow neighbours until they have parted by the largest share, or a third of a series."""
    directions = _directions(states)
    saturated = _saturation(states, directions, generator)
    steps, least = _FIRST_STEPS, states.shape[1] // 3
    while True:
        series_of, log_distance = _followed(
            states, directions, min(steps, least), window, REFERENCES, generator
        )
        mean = log_distance.mean(axis=0)
        levels = [mean[0] + share * (saturated - mean[0]) for share in FITTED]
        if steps >= least or mean[0] < max(levels) < mean.max():
            break
        steps *= 2
    ends = [int(np.argmax(mean > level)) for level in levels if mean[0] < level < mean.max()]
    if not ends:
        raise NoExponentError(
            "no exponent can be seen in these series: neighbouring states do not part within "
            f"{least} steps, a third of a series"
        )
    return _Curves(series_of, log_distance, saturated, ends)


def _resampled_rates(
    curves: _Curves,
    mean: FloatArray,
    fits: Sequence[tuple[float, FloatArray]],
    weights: IntArray,
) -> FloatArray:
    """Rates of growth in a bootstrap over series, ``(fits, resamples)``.

    To first order, the rate of a fit is linear in the curve, so that contributions of pairs add up.
    ``weights``: How often each series is drawn, ``(resamples, series)``.
    """
    count = weights.shape[1]
    number = weights @ np.bincount(curves.series_of, minlength=count)
    rates = []
    for rate, sensitivity in fits:
        departures = (curves.log_distance - mean)[:, : sensitivity.size] @ sensitivity
        by_series = np.bincount(curves.series_of, weights=departures, minlength=count)
        with np.errstate(invalid="ignore", divide="ignore"):
            rates.append(rate + (weights @ by_series) / number)
    return np.array(rates)


def _growth(curve: FloatArray, saturated: float, power: int) -> tuple[float, FloatArray]:
    """Fit growth that saturates, above a floor, to the mean logarithm of the distance.

    Returns its rate per step, and how far each point of the curve sets it.

    Without the floor, a distance d grows by ``rate * d * (1 - (d / saturated) ** power)`` a
    step; squares of distance and floor add up. The first point, by which neighbours were
    chosen, is left out.
    """
    steps = np.arange(1, curve.size)

    def departures(parameters: FloatArray) -> FloatArray:
        rate, first, floor = parameters
        left = np.log(np.expm1(power * (saturated - first))) - power * rate * steps
        grown = saturated - np.logaddexp(0.0, left) / power
        return np.asarray(np.logaddexp(2 * grown, 2 * floor) / 2 - curve[1:])

    slope = (curve[-1] - curve[0]) / steps[-1]
    lowest = curve[0] - _FAINT
    bounds = ([0.0, lowest, lowest], [np.inf, saturated - 1e-3, saturated])
    trials = [
        scipy.optimize.least_squares(
            departures, [slope * factor, curve[0] - 0.1, curve[0] - below], bounds=bounds
        )
        for factor in (0.7, 1.5)
        for below in (0.5, 2.0)
    ]
    best = min(trials, key=lambda trial: trial.cost)
    # a floor that is not there leaves a column of zeros, which the pseudo-inverse ignores
    sensitivity = np.linalg.pinv(np.asarray(best.jac), rcond=1e-6)[0]
    return float(best.x[0]), np.concatenate([[0.0], sensitivity])


def correlation_steps(series: FloatArray) -> int:
    """Steps until the autocorrelation of series ``(series, time, component)`` is below 1 / e.

    A quarter of the series if it is not before that.
    """
    # the same sums with and without NaN, but in another order
    mean = np.mean if series_lengths(series) is None else np.nanmean
    departures = series - mean(series, axis=(0, 1))
    variance = mean(np.square(departures))
    most = int(series.shape[1] // 4)
    for lag in range(1, most):
        if mean(departures[:, lag:] * departures[:, :-lag]) < variance / np.e:
            return lag
    return max(1, most)


def _followed(
    states: FloatArray,
    directions: FloatArray,
    steps: int,
    window: int,
    most: int,
    generator: np.random.Generator,
) -> tuple[IntArray, FloatArray]:
    """Follow the nearest neighbours of ``most`` states at most for some steps.

    Returns the series of the first of each pair, and how the logarithm of their distance went on.
    """
    # both are followed to the end: the mean is over the same pairs at all times
    starts = states.shape[1] - steps
    inside = np.flatnonzero(~np.isnan(states[:, steps:]).any(axis=2))
    series_of, step_of = np.divmod(inside, starts)
    candidates = states[:, :starts].reshape(-1, states.shape[2])[inside]
    if not len(candidates):
        raise NoExponentError("no state has a neighbour: the series are too short")
    tree = scipy.spatial.cKDTree(candidates)
    chosen = generator.choice(
        len(candidates), min(most, len(candidates)), replace=False, shuffle=False
    )
    chosen.sort()
    neighbour = np.full(len(chosen), -1)
    waiting, count = np.arange(len(chosen)), 2
    while len(waiting) and count <= min(_MOST_CANDIDATES, len(candidates)):
        here = chosen[waiting][:, np.newaxis]
        nearest = np.asarray(tree.query(candidates[chosen[waiting]], k=count)[1])
        distinct = (series_of[nearest] != series_of[here]) | (
            np.abs(step_of[nearest] - step_of[here]) > window
        )
        has = distinct.any(axis=1)
        neighbour[waiting[has]] = nearest[has, distinct[has].argmax(axis=1)]
        waiting, count = waiting[~has], 4 * count
    has_neighbour = neighbour >= 0
    if not has_neighbour.any():
        raise NoExponentError("no state has a neighbour: the series are too short")
    of_pairs, neighbour = chosen[has_neighbour], neighbour[has_neighbour]
    series, step = series_of[of_pairs], step_of[of_pairs]
    other_series, other_step = series_of[neighbour], step_of[neighbour]
    distance = np.empty((len(series), steps + 1))
    for ahead in range(steps + 1):
        apart = states[series, step + ahead] - states[other_series, other_step + ahead]
        distance[:, ahead] = _across(apart, directions[series, step + ahead])
    # states that were measured twice have no distance at first
    apart_at_all = (distance > 0).all(axis=1)
    if 2 * apart_at_all.sum() < len(distance):
        raise NoExponentError(
            f"{len(distance) - apart_at_all.sum()} of {len(distance)} pairs of neighbouring "
            "states are at distance 0: the readings are too coarse, or stuck"
        )
    return series[apart_at_all], np.log(distance[apart_at_all])


def _departure_from_noise(
    series: FloatArray, log_distance: FloatArray, window: int, generator: np.random.Generator
) -> float:
    """How much closer neighbours stay than in surrogates of either kind, in standard deviations."""
    departures = []
    for normal in (False, True):
        means = []
        for _ in range(SURROGATES):
            noise = surrogate(series, generator, normal=normal)
            states = _embedded(noise, DELAYS.get(noise.shape[2], 1), window)
            steps, most = log_distance.size - 1, SURROGATE_REFERENCES
            _, followed = _followed(states, _directions(states), steps, window, most, generator)
            means.append(followed.mean())
        error = np.std(means, ddof=1) * np.sqrt(1 + 1 / SURROGATES)
        departures.append(float((np.mean(means) - log_distance.mean()) / error))
    return min(departures)


def surrogate(series: FloatArray, generator: np.random.Generator, *, normal: bool) -> FloatArray:
    """Noise with the spectra, cross-spectra and distributions of series.

    The phases of the Fourier transform are drawn, the same for all components, and the given values
    are put in the order of the result. The line from the first to the last value of each series
    stays, so that a random walk has no jump at its ends. ``normal``: Whether values are first
    replaced by normal ones of the same ranks, which turns a function of normal noise into that
    noise.
    """
    there = ~np.isnan(series[..., 0])
    flat, values = series[there], series.copy()
    if normal:
        values[there] = scipy.special.ndtri((_ranks(flat) + 0.5) / len(flat))
    if there.all():
        noise = _with_drawn_phases(values, generator)
    else:
        noise = padded(
            [_with_drawn_phases(run[np.newaxis], generator)[0] for run in without_padding(values)]
        )
    order = _ranks(noise[there])
    values[there] = np.take_along_axis(np.sort(flat, axis=0), order, axis=0)
    return values


def _with_drawn_phases(values: FloatArray, generator: np.random.Generator) -> FloatArray:
    """Series ``(series, time, component)`` with the same spectra, about the line between ends."""
    first, last = values[:, :1], values[:, -1:]
    line = first + (last - first) * np.linspace(0.0, 1.0, values.shape[1])[:, np.newaxis]
    spectrum = np.fft.rfft(values - line, axis=1)
    phases = 2j * np.pi * generator.random((*spectrum.shape[:2], 1))
    phases[:, 0] = 0.0  # the mean stays
    return line + np.fft.irfft(spectrum * np.exp(phases), values.shape[1], axis=1)


def _ranks(values: FloatArray) -> IntArray:
    """Ranks of values in their column, from 0."""
    return np.asarray(values.argsort(axis=0, kind="stable").argsort(axis=0), dtype=np.int64)


def _saturation(
    states: FloatArray, directions: FloatArray, generator: np.random.Generator
) -> float:
    """Mean logarithm of the distance of two states at random."""
    flat, along = map(samples_of, (states, directions))
    first, second = generator.integers(len(flat), size=(2, _RANDOM_PAIRS))
    distance = _across(flat[first] - flat[second], along[first])
    return float(np.log(distance[distance > 0]).mean())


def _directions(states: FloatArray) -> FloatArray:
    """Unit vectors along the trajectories; zero where a state rests."""
    if series_lengths(states) is None:
        change: FloatArray = np.gradient(states, axis=1)
    else:
        change = padded([_change(run) for run in without_padding(states)])
    length = np.linalg.norm(change, axis=2, keepdims=True)
    change /= np.where(length > 0, length, 1.0)
    return change


def _change(states: FloatArray) -> FloatArray:
    """Changes from step to step of a series ``(time, component)``; none where it has one sample."""
    return np.gradient(states, axis=0) if len(states) > 1 else np.zeros_like(states)


def _across(apart: FloatArray, direction: FloatArray) -> FloatArray:
    """Lengths of differences of states across the flow, ``(pairs,)``."""
    along = (apart * direction).sum(axis=1, keepdims=True)
    return np.asarray(np.linalg.norm(apart - along * direction, axis=1))


def _embedded(states: FloatArray, copies: int, lag: int) -> FloatArray:
    """Delay coordinates of series, ``(series, time, copies * component)``."""
    length = states.shape[1] - (copies - 1) * lag
    if length < 2:  # a direction takes two
        raise NoExponentError("the series are too short beside their own correlation time")
    parts = [states[:, copy * lag : copy * lag + length] for copy in range(copies)]
    embedded = np.concatenate(parts, axis=2)
    embedded[np.isnan(embedded).any(axis=2)] = np.nan
    return embedded[~np.isnan(embedded).all(axis=(1, 2))]
