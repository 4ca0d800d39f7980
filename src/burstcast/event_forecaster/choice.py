"""The best kind of forecaster for some series: ``kind="auto"``.

Every kind that learns from series is fitted, cheap ones first, and scored by the forecasts of
training series that calibrate it, which it has not learnt from. The highest Brier skill wins, the
cheaper kind where skills are equal; kinds within the standard error of their difference from it are
as good for all that these series tell.
"""

import copy
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from burstcast.base import random_streams
from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.base.resampling import bootstrap_weights, percentile_interval
from burstcast.base.series_lengths import series_lengths
from burstcast.data.series_layout import labelled_series
from burstcast.data.starting_points import SeriesPoints
from burstcast.event_forecaster.score_intervals import blocks_of
from burstcast.forecasters._event_classifier import EventClassifier
from burstcast.forecasts.alarms import isotonic, logistic
from burstcast.forecasts.probabilities import rounded
from burstcast.forecasts.scores import Outcomes, outcomes_by_series

if TYPE_CHECKING:
    from burstcast.event_forecaster.forecaster import EventForecaster

AUTO = "auto"
KINDS = (
    *("linear_inverse", "analogues", "nvar", "quadratic", "quadratic_filtered"),
    *("precursor", "esn_direct", "esn"),
)
"""Kinds that are tried, in the order of their cost; a choice between equals takes the first."""

_SECONDS = {
    **{"linear_inverse": 0.1, "analogues": 0.5, "nvar": 0.1, "quadratic": 0.3},
    **{"quadratic_filtered": 0.4, "precursor": 3.0, "esn_direct": 4.5, "esn": 0.04},
}
"""Time of a fit to 10,000 samples on one core, roughly; of networks, for 100 neurons and one set of
hyperparameters."""

_FOLDS, _RESAMPLES, _CONFIDENCE = 10, 1000, 0.95
_NEGLIGIBLE = 0.002
"""Brier skill that is not worth a dearer kind."""
_ENDING = ("analogues",)
"""Kinds whose forecasts end where training series end, which is no divergence."""
_FINITE = 0.9
"""Share of finite forecasts of the training series that a kind must have."""


@dataclass(frozen=True)
class LeftOutForecasts:
    """What calibrates a forecaster at one prediction time, at points without an event under way."""

    happened: BoolArray  #: whether an event followed, ``(points,)``
    values: FloatArray  #: votes, or probabilities of a classifier, ``(points,)``
    series: IntArray  #: row of the series of each point, ``(points,)``
    step: IntArray  #: sample of each point in its series, ``(points,)``
    reach: int  #: samples to the end of the last prediction window
    prior: float | None  #: weight of the prior of shares of votes; None: values are probabilities

    def errors(self) -> tuple[FloatArray, FloatArray]:
        """Squared errors of calibrated probabilities and of the base rate, both ``(points,)``.

        Both come from other series than the point's.
        """
        fold = np.unique(self.series, return_inverse=True)[1] % _FOLDS
        happened = self.happened.astype(np.float64)
        probability, base = np.empty(len(fold)), np.empty(len(fold))
        for number in range(int(fold.max()) + 1):
            here = fold == number
            outcomes = self._outcomes(~here)
            rule = logistic(outcomes) if self.prior is None else isotonic(outcomes, self.prior)
            probability[here] = rule(self.values[here])
            base[here] = happened[~here].mean()
        return (probability - happened) ** 2, (base - happened) ** 2

    def _outcomes(self, rows: BoolArray) -> Outcomes:
        number = int(rows.sum())
        whole, quiet = np.zeros(number, dtype=np.int64), np.ones(number, dtype=bool)
        values, happened = self.values[rows], self.happened[rows]
        return outcomes_by_series(values, happened, quiet, whole, 1).total()


@dataclass(frozen=True)
class Trial:
    """One kind that was tried."""

    kind: str  #: its name
    #: brier_skill, low, high: mean Brier skill over prediction times in series that were left out,
    #: with its 95 % interval over series; NaN where the kind failed
    brier_skill: float = float("nan")
    low: float = float("nan")
    high: float = float("nan")
    error: float = float("nan")  #: standard error of the difference from the chosen kind
    seconds: float = 0.0  #: time of the fit
    remark: str = ""  #: why it is not to be had
    #: options that samples are too coarse for, with the nearest values that fit; others: defaults
    options: Mapping[str, Any] = field(default_factory=dict)

    @property
    def adapted(self) -> str:
        """A sentence on options that are not the defaults; empty if all are."""
        if not self.options:
            return ""
        values = (f"{name}={np.round(value, 3).tolist()}" for name, value in self.options.items())
        return (
            f"{self.kind} has {' and '.join(values)}, the nearest to its defaults that these "
            f"samples resolve"
        )


def choose(
    forecaster: "EventForecaster",
    series: Any,
    parameters: Any,
    kinds: Sequence[str],
    stage: Callable[[str], None] = lambda _: None,
) -> "tuple[EventForecaster, list[Trial]]":
    """Fit all kinds, and return the best fitted forecaster with what was tried.

    Raises ValueError, with what all kinds say, if none can be fitted.
    """
    fitted, skills, trials = tried(forecaster, series, parameters, kinds, stage)
    if not fitted:
        said = "; ".join(f"{trial.kind}: {trial.remark}" for trial in trials)
        raise ValueError(f"kind is 'auto', but no kind can be fitted: {said}")
    best = best_kind(skills)
    listed = []
    for trial in trials:
        if trial.kind in skills:
            deviation = float((skills[trial.kind] - skills[best])[1:].std())
            trial = replace(trial, error=deviation)
        listed.append(trial)
    return fitted[best], listed


def tried(
    forecaster: "EventForecaster",
    series: Any,
    parameters: Any,
    kinds: Sequence[str],
    stage: Callable[[str], None] = lambda _: None,
) -> "tuple[dict[str, EventForecaster], dict[str, FloatArray], list[Trial]]":
    """All kinds: fitted forecasters and samples of their skill by kind, and a list of the trials.

    The first sample is the skill, the others resample series, ``(1 + resamples,)``. Kinds that
    cannot be fitted are only in the list.
    """
    fitted: dict[str, EventForecaster] = {}
    skills: dict[str, FloatArray] = {}
    trials: list[Trial] = []
    for kind in kinds:
        stage(kind)
        made = copy.copy(forecaster).set_params(kind=kind, options=None)
        options: dict[str, Any] = {}
        begun = time.perf_counter()
        try:
            options = made.resolved_options()
            made.set_params(options=options or None)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                made.fit(series, parameters=parameters, verbose=False)
                if not _stays_finite(made, series):
                    raise ValueError("forecasts of training series do not stay finite")
                samples = _skill_samples(made)
        except (ValueError, TypeError, FloatingPointError) as error:
            seconds = time.perf_counter() - begun
            trials.append(Trial(kind, seconds=seconds, remark=str(error), options=options))
            continue
        seconds = time.perf_counter() - begun
        low, high = percentile_interval(samples[1:], _CONFIDENCE)
        fitted[kind], skills[kind] = made, samples
        skill = float(samples[0])
        trials.append(Trial(kind, skill, low, high, seconds=seconds, options=options))
    return fitted, skills, trials


def best_kind(skills: Mapping[str, FloatArray]) -> str:
    """The first kind with the highest skill, but for `_NEGLIGIBLE`."""
    highest = max(samples[0] for samples in skills.values())
    return next(kind for kind, samples in skills.items() if samples[0] >= highest - _NEGLIGIBLE)


def _skill_samples(made: "EventForecaster") -> FloatArray:
    """Brier skill, and its bootstrap samples over blocks of series, ``(1 + resamples,)``.

    All kinds have the same samples of blocks, so that differences of kinds are paired.
    """
    of_times = []
    for left_out in made.left_out_.values():
        errors, reference = left_out.errors()
        block = blocks_of(SeriesPoints(left_out.series, left_out.step), left_out.reach)
        sums = [np.bincount(block, weights=each) for each in (errors, reference)]
        generator = random_streams.stream(made.random_seed, "choice of a kind")
        weights = bootstrap_weights(len(sums[0]), _RESAMPLES, generator)
        weights = np.concatenate([np.ones((1, len(sums[0]))), weights])
        total, of_reference = (weights @ each for each in sums)
        with np.errstate(divide="ignore", invalid="ignore"):
            of_times.append(np.nan_to_num(1.0 - total / of_reference, nan=0.0, neginf=0.0))
    return np.asarray(np.mean(of_times, axis=0))


def _stays_finite(made: "EventForecaster", series: Any) -> bool:
    """Whether the kept forecaster, and not only its refits, forecasts the training series."""
    if isinstance(made.members_[0], EventClassifier) or made.kind in _ENDING:
        return True
    states = labelled_series(series).states
    lengths, reach = series_lengths(states), next(iter(made.left_out_.values())).reach
    shortest = states.shape[1] if lengths is None else int(lengths.min())
    try:
        forecasts = made.forecast(states[:, : max(1, shortest - reach)])
    except ValueError:  # series shorter than a washout
        return True
    return bool(np.isfinite(forecasts).all(axis=(2, 3)).mean() >= _FINITE)


def findings(trials: Sequence[Trial], chosen: str, events: int) -> Iterator[str]:
    """Sentences on the choice: other options than the defaults; no kind beats the base rate."""
    best = next(trial for trial in trials if trial.kind == chosen)
    if best.adapted:
        yield best.adapted
    if not best.low > 0:
        yield (
            f"no kind beats the base rate: the best, {chosen}, has a Brier skill of "
            f"{best.brier_skill:.2f} ({best.low:.2f} to {best.high:.2f}) in training series that "
            f"were left out; {events} events are too few to tell, or the series do not tell of "
            f"events (choices_ has all kinds)"
        )


def cost(kinds: Sequence[str], series: FloatArray, forecaster: "EventForecaster") -> str:
    """A sentence on how long trials of all kinds take, roughly.

    ``series``: ``(series, time, component)``.
    """
    samples = series.shape[0] * series.shape[1] / 10_000
    searched = forecaster.searches * (forecaster.grid**2 + forecaster.bayesian_points)
    networks = (searched + forecaster.members) * (forecaster.neurons / 100) ** 1.3
    seconds = {kind: _SECONDS.get(kind, 1.0) * samples for kind in kinds}
    if "esn" in seconds:
        seconds["esn"] *= networks
    total = sum(seconds.values())
    dearest = max(seconds, key=lambda kind: seconds[kind])
    return (
        f"kind='auto' fits {', '.join(kinds)}, which takes some {rounded(total)} on one core, "
        f"{rounded(seconds[dearest])} of them for {dearest}; fewer kinds: "
        f"options={{'kinds': [...]}}"
    )
