"""Return levels of a record by peaks over a threshold.

The excesses of a high threshold by the peaks of separate events follow a generalised Pareto
distribution (Pickands, Annals of Statistics 3 (1975) 119; Coles, An Introduction to Statistical
Modeling of Extreme Values, 2001, chapter 4). Return levels beyond the record come from the fit, if
the threshold is high enough. Where the distribution of excesses is of another form,
as for an observable with an upper bound and a threshold that is merely the definition of an event,
the fit promises levels that do not exist. Hence the threshold is chosen by a test of the fit.
"""

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy
from scipy.optimize import brentq, minimize, minimize_scalar
from scipy.stats import genpareto

from burstcast.base.arrays import FloatArray, IntArray

LEAST_PEAKS = 30
"""Peaks above a threshold without which its tail is not fitted."""

_EXCLUDED = 1e6
"""Cost of parameters without a likelihood; finite, as minimisers want it."""


class UnfitTailError(ValueError):
    """No threshold has excesses of a generalised Pareto distribution."""


@dataclass(frozen=True)
class ParetoTail:
    """Peaks above a threshold, as a Poisson process of generalised Pareto distributed excesses."""

    threshold: float
    shape: float  #: xi: negative for a bounded tail, 0 for an exponential one
    scale: float  #: sigma, positive, in units of the observable
    peaks: int  #: number of peaks at or above the threshold
    time: float  #: time of observation

    @property
    def rate(self) -> float:
        """Peaks per unit of time."""
        return self.peaks / self.time

    @property
    def upper_end(self) -> float:
        """Largest possible value; infinite if the shape is not negative."""
        return self.threshold - self.scale / self.shape if self.shape < 0 else math.inf

    def level(self, period: float) -> float:
        """Level that is reached once in a period, which must exceed 1 / `rate`."""
        return (
            self.threshold + float(_growth(self.shape, math.log(period * self.rate))) * self.scale
        )


@dataclass(frozen=True)
class ThresholdChoice:
    """Fits above candidate thresholds, ``(candidates,)`` each, for the stability plot."""

    thresholds: FloatArray
    peaks: IntArray
    shape: FloatArray
    #: shape_low, shape_high: profile-likelihood interval of the shape
    shape_low: FloatArray
    shape_high: FloatArray
    #: scale - shape * threshold, which no longer depends on the threshold once it is high enough
    modified_scale: FloatArray
    #: probability of a worse fit if the excesses are generalised Pareto distributed: Anderson-
    #: Darling statistic, parametric bootstrap
    p_value: FloatArray
    chosen: int  #: the first candidate with a p-value of at least ``significance``


@dataclass(frozen=True)
class ReturnLevels:
    """Return levels of a record, ``(periods,)`` each."""

    periods: FloatArray
    level: FloatArray
    #: low, high: profile-likelihood interval
    low: FloatArray
    high: FloatArray
    tail: ParetoTail
    choice: ThresholdChoice


def declustered_peaks(
    observable: FloatArray, threshold: float, run_length: int, ceiling: float | None = None
) -> FloatArray:
    """Peaks of separate exceedances of a threshold, ``(peaks,)``.

    Exceedances belong to one event until the observable has been below the threshold for
    ``run_length`` steps (runs declustering). ``observable``: Series ``(series, samples)``, or one.
    ``ceiling``: Events that exceed it are left out, such as laminarisations.

    Examples
    --------
    >>> import numpy as np
    >>> declustered_peaks(np.array([0.0, 2.0, 0.0, 3.0, 0.0, 0.0, 1.5]), 1.0, run_length=2).tolist()
    [3.0, 1.5]
    """
    if run_length < 1:
        raise ValueError(f"separate events lie a step apart at least, not {run_length}")
    peaks: list[float] = []
    for series in np.atleast_2d(observable):
        above = np.flatnonzero(series >= threshold)
        if above.size:
            starts = np.flatnonzero(np.diff(above, prepend=above[0] - run_length - 1) > run_length)
            peaks += np.maximum.reduceat(series[above], starts).tolist()
    found = np.array(peaks)
    return found if ceiling is None else found[found <= ceiling]


def fit_tail(peaks: FloatArray, threshold: float, time: float) -> ParetoTail:
    """Fit the tail above a threshold by maximum likelihood.

    The likelihood is maximised along one parameter, shape / scale (Grimshaw, Technometrics 35
    (1993) 185); shapes below -1, where it has no maximum, are excluded. ``peaks``: Peaks, of which
    those at or above the threshold count. ``time``: Time of observation.
    """
    excesses = peaks[peaks >= threshold] - threshold
    if len(excesses) < 2 or not excesses.max() > 0:
        raise ValueError(f"a tail above {threshold:g} needs two different peaks at least")
    if not time > 0:
        raise ValueError(f"the time of observation must be positive, not {time}")
    shape, scale = _estimate(excesses)
    return ParetoTail(threshold, shape, scale, len(excesses), time)


def choose_threshold(
    peaks: FloatArray,
    time: float,
    generator: np.random.Generator,
    *,
    candidates: Sequence[float] | None = None,
    significance: float = 0.1,
    confidence: float = 0.95,
    resamples: int = 99,
) -> ThresholdChoice:
    """Choose the lowest threshold whose excesses pass for generalised Pareto distributed.

    It is the first of the candidates whose Anderson-Darling statistic is exceeded by at least a
    share ``significance`` of samples of the fitted distribution (parametric bootstrap; cf. Bader,
    Yan & Zhang, Annals of Applied Statistics 12 (2018) 310).

    Parameters
    ----------
    peaks
        Peaks of separate events, ``(peaks,)`` (`declustered_peaks`).
    time
        Time of observation.
    generator
        Source of the bootstrap samples.
    candidates
        Rising thresholds; by default the lowest peak and every tenth percentile of the peaks, as
        long as `LEAST_PEAKS` lie above.

    Raises
    ------
    UnfitTailError
        If no candidate passes, or none has enough peaks.
    """
    if candidates is None:
        candidates = np.unique(np.quantile(peaks, np.arange(0.0, 1.0, 0.1))).tolist()
    usable = [level for level in candidates if (peaks >= level).sum() >= LEAST_PEAKS]
    if not usable:
        raise UnfitTailError(
            f"fewer than {LEAST_PEAKS} peaks lie above each candidate threshold: there are "
            f"{len(peaks)} in all"
        )
    tails = [fit_tail(peaks, threshold, time) for threshold in usable]
    p_values = [_p_value(peaks, tail, generator, resamples) for tail in tails]
    passing = [number for number, value in enumerate(p_values) if value >= significance]
    if not passing:
        raise UnfitTailError(
            "excesses of no threshold pass for generalised Pareto distributed: the largest p-value "
            f"is {max(p_values):.2g}, above {usable[int(np.argmax(p_values))]:g}"
        )
    ends = [_shape_interval(peaks[peaks >= tail.threshold], tail, confidence) for tail in tails]
    return ThresholdChoice(
        thresholds=np.array(usable),
        peaks=np.array([tail.peaks for tail in tails]),
        shape=np.array([tail.shape for tail in tails]),
        shape_low=np.array([low for low, _ in ends]),
        shape_high=np.array([high for _, high in ends]),
        modified_scale=np.array([tail.scale - tail.shape * tail.threshold for tail in tails]),
        p_value=np.array(p_values),
        chosen=passing[0],
    )


def return_levels(
    peaks: FloatArray,
    time: float,
    periods: npt.ArrayLike,
    generator: np.random.Generator,
    *,
    candidates: Sequence[float] | None = None,
    confidence: float = 0.95,
    significance: float = 0.1,
) -> ReturnLevels:
    """Return levels of a record, with profile-likelihood intervals.

    The threshold is chosen by `choose_threshold`. A warning says so where the lowest candidate is
    rejected: a fit above it would promise other levels. The likelihood is that of a Poisson process
    of peaks, so that intervals include the uncertainty of their rate.

    Parameters
    ----------
    peaks, time, generator, candidates, significance
        As of `choose_threshold`.
    periods
        Return periods, in the unit of ``time``; longer than the mean time between two peaks above
        the chosen threshold.
    confidence
        Probability that an interval covers, for many peaks. Of 150 peaks, at a period seven times
        as long as the record, intervals of 0.95 hold for 88 % of records, and most of the others
        end too low.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.statistics.return_levels import return_levels
    >>> peaks = np.random.default_rng(0).exponential(size=400)
    >>> found = return_levels(peaks, 400.0, [100.0], np.random.default_rng(1))
    >>> bool(found.low[0] < np.log(100.0) < found.high[0])
    True
    """
    choice = choose_threshold(
        peaks,
        time,
        generator,
        candidates=candidates,
        significance=significance,
        confidence=confidence,
    )
    tail = fit_tail(peaks, float(choice.thresholds[choice.chosen]), time)
    if choice.chosen:
        warnings.warn(
            f"excesses of {choice.thresholds[0]:g} are not generalised Pareto distributed (p = "
            f"{choice.p_value[0]:.2g}); the threshold is {tail.threshold:g}, and levels of a fit "
            "above a lower one would be wrong",
            stacklevel=2,
        )
    wanted = np.atleast_1d(np.asarray(periods, dtype=np.float64))
    if not (wanted * tail.rate > 1).all():
        raise ValueError(
            f"return periods must exceed {1 / tail.rate:.4g}, the mean time between two peaks "
            f"above the threshold {tail.threshold:g}; levels below it are counted by return_times"
        )
    above = peaks[peaks >= tail.threshold]
    ends = np.array([_level_interval(above, tail, period, confidence) for period in wanted])
    levels = np.array([tail.level(period) for period in wanted])
    return ReturnLevels(wanted, levels, ends[:, 0], ends[:, 1], tail, choice)


# -- likelihood ------------------------------------------------------------------------------------


def _growth(shape: float, logarithm: float) -> float:
    """(exp(shape * logarithm) - 1) / shape; the logarithm itself at shape 0."""
    product = shape * logarithm
    return logarithm if abs(product) < 1e-9 else math.expm1(product) / shape


def _log_likelihood(excesses: FloatArray, shape: float, scale: float) -> float:
    """Logarithm of the likelihood of excesses; minus infinity outside of the support."""
    if abs(shape) < 1e-9:
        return float(-len(excesses) * math.log(scale) - excesses.sum() / scale)
    relative = shape / scale * excesses
    if relative.min() <= -1:
        return -math.inf
    return float(-len(excesses) * math.log(scale) - (1 + 1 / shape) * np.log1p(relative).sum())


def _estimate(excesses: FloatArray) -> tuple[float, float]:
    """Shape and scale of the largest likelihood."""
    mean, largest = float(excesses.mean()), float(excesses.max())

    def shape_of(ratio: float) -> float:
        return float(np.log1p(ratio * excesses).mean())

    def cost(ratio: float) -> float:
        if abs(ratio) < 1e-9 / mean:
            return math.log(mean) + 1
        shape = shape_of(ratio)
        return math.log(shape / ratio) + 1 + shape if shape > -1 else _EXCLUDED

    near_end = np.geomspace(1e-6, 0.999, 25) / largest
    ratios = np.concatenate([near_end - 1 / largest, np.geomspace(1e-3, 30.0, 15) / mean])
    shapes = np.log1p(np.outer(ratios, excesses)).mean(axis=1)
    costs = np.log(shapes / ratios) + 1 + shapes
    best = int(np.argmin(np.where(shapes > -1, costs, np.inf)))
    bounds = float(ratios[max(best - 1, 0)]), float(ratios[min(best + 1, len(ratios) - 1)])
    found = minimize_scalar(cost, bounds=bounds, method="bounded", options={"xatol": 1e-12})
    ratio = float(found.x)
    # beyond the largest excess, where the likelihood of shape -1 is largest
    edge = -1.0, largest
    if abs(ratio) < 1e-9 / mean:
        return 0.0, mean
    inner = shape_of(ratio), shape_of(ratio) / ratio
    at_edge = -len(excesses) * math.log(largest)
    return inner if _log_likelihood(excesses, *inner) >= at_edge else edge


def _anderson_darling(excesses: FloatArray, shape: float, scale: float) -> float:
    number = len(excesses)
    ordered = np.clip(genpareto.cdf(np.sort(excesses), shape, scale=scale), 1e-15, 1 - 1e-15)
    weight = (2 * np.arange(1, number + 1) - 1) / number
    return float(-number - (weight * (np.log(ordered) + np.log1p(-ordered[::-1]))).sum())


def _p_value(
    peaks: FloatArray, tail: ParetoTail, generator: np.random.Generator, resamples: int
) -> float:
    """Share of samples of the fitted distribution that fit worse than the peaks do."""
    excesses = peaks[peaks >= tail.threshold] - tail.threshold
    statistic = _anderson_darling(excesses, tail.shape, tail.scale)
    worse = 1
    for uniform in generator.random((resamples, len(excesses))):
        drawn = genpareto.ppf(uniform, tail.shape, scale=tail.scale)
        worse += _anderson_darling(drawn, *_estimate(drawn)) >= statistic
    return worse / (resamples + 1)


def _ends(
    deviance: Callable[[float], float], best: float, step: float, confidence: float
) -> tuple[float, float]:
    """Ends between which a deviance stays below its quantile; infinite where it does on and on."""
    most = float(scipy.special.chdtri(1, 1 - confidence))
    ends = []
    for direction in (-1.0, 1.0):
        inner, width = best, step
        for _ in range(40):
            outer = inner + direction * width
            if deviance(outer) > most:
                found = brentq(lambda x: deviance(x) - most, inner, outer, xtol=1e-4 * step)
                ends.append(float(found))
                break
            inner, width = outer, 1.5 * width
        else:
            ends.append(direction * math.inf)
    return ends[0], ends[1]


def _shape_interval(peaks: FloatArray, tail: ParetoTail, confidence: float) -> tuple[float, float]:
    """Profile-likelihood interval of the shape."""
    excesses = peaks - tail.threshold
    best = _log_likelihood(excesses, tail.shape, tail.scale)

    def deviance(shape: float) -> float:
        least = max(0.0, -shape * float(excesses.max())) * (1 + 1e-12)
        bounds = math.log(max(least, 0.05 * tail.scale)), math.log(least + 20 * tail.scale)

        def cost(logarithm: float) -> float:
            return min(_EXCLUDED, -_log_likelihood(excesses, shape, math.exp(logarithm)))

        found = minimize_scalar(cost, bounds=bounds, method="bounded")
        return 2 * (best + float(found.fun))

    return _ends(deviance, tail.shape, 0.5 / math.sqrt(len(excesses)), confidence)


def _level_interval(
    peaks: FloatArray, tail: ParetoTail, period: float, confidence: float
) -> tuple[float, float]:
    """Profile-likelihood interval of the level of a period, over the shape and the rate."""
    excesses, number = peaks - tail.threshold, tail.peaks
    level, rate = tail.level(period) - tail.threshold, math.log(tail.rate)

    def cost(shape: float, change: float, height: float) -> float:
        """Negative logarithm of the likelihood, from the largest one on."""
        growth = _growth(shape, math.log(period) + rate + change)
        if growth <= 0 or height <= 0:
            return math.inf
        of_peaks = number * (change - math.expm1(change))
        return largest - _log_likelihood(excesses, shape, height / growth) - of_peaks

    largest = _log_likelihood(excesses, tail.shape, tail.scale)
    shapes = tail.shape + np.linspace(-0.8, 1.2, 21)
    spread = 1 / math.sqrt(number)

    def deviance(height: float) -> float:
        costs = [cost(float(shape), 0.0, height) for shape in shapes]
        start = float(shapes[int(np.argmin(costs))])
        if not math.isfinite(min(costs)):
            return _EXCLUDED
        corners = np.array([[start, 0.0], [start + 0.05, 0.0], [start, spread]])
        options: Any = {"initial_simplex": corners, "xatol": 1e-5, "fatol": 1e-5}
        of_both: Any = lambda at: min(_EXCLUDED, cost(at[0], at[1], height))  # noqa: E731
        found: Any = minimize(of_both, corners[0], method="Nelder-Mead", options=options)
        return 2 * float(found.fun)

    low, high = _ends(deviance, level, 0.05 * level, confidence)
    return tail.threshold + max(low, 0.0), tail.threshold + high
