"""Events of an event forecaster: durations in samples, prediction windows, outcomes, alarms."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from burstcast.base import durations
from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.data.events import upward_crossings
from burstcast.event_forecaster.choice import LeftOutForecasts
from burstcast.forecasters._event_classifier import LabelledPoints
from burstcast.forecasters.base import Forecaster
from burstcast.forecasts.alarms import AlarmRule, isotonic, logistic
from burstcast.forecasts.points import ObservedPoints
from burstcast.forecasts.scores import (
    ContingencyTable,
    Outcomes,
    base_rate,
    brier_score,
    counts_at,
    outcomes_by_series,
    useless_votes,
)
from burstcast.forecasts.windows import WindowSummaries, crosses, share_of_votes, valid_votes
from burstcast.statistics.neighbour_divergence import correlation_steps

FEW_EVENTS = 10
"""Events in training series that a forecaster can learn from and be calibrated with, at least."""
LITTLE_SKILL = 0.05
"""Brier skill in series that were left out, below which probabilities are no better than the base
rate: a tenth of the skill of most useful forecasts."""
_FEW_QUIET = 0.5
"""Share of starting points without an event in their washout, below which it may be too long."""
_ROUGH = 1.1
"""Samples in a Lyapunov time over whole ones, beyond which a warning says that it is rounded."""
_FOLDS = 10
"""Parts of the training series, each of which has alarms by rules of the others."""

ByTime = dict[float, FloatArray]
"""What probabilities are made from at each prediction time: shares of votes, ``(points,)``."""


def invalid_share(share: float, where: str, kind: Forecaster) -> Iterator[str]:
    """A sentence about a share of forecasts that are invalid, unless it is small."""
    if share > kind.tolerated_invalid:
        yield (
            f"{share:.1%} of the forecasts {where} are invalid ({kind.why_invalid}): they predict "
            "no event"
        )


@dataclass(frozen=True)
class EventTiming:
    """Durations in samples, and the forecast windows."""

    #: in the unit of time of ``sampling_interval``; None: all durations are in samples
    lyapunov_time: float | None
    sampling_interval: float  #: time between two samples
    prediction_times: Sequence[float]  #: from the present to the beginning of each window
    window: float  #: length of the windows

    def __post_init__(self) -> None:
        if not len(self.prediction_times):
            raise ValueError("prediction_times must have one entry at least")
        if self.lyapunov_time is not None and not self.lyapunov_time > 0:
            raise ValueError(f"lyapunov_time must be positive, not {self.lyapunov_time}")

    @cached_property
    def unit(self) -> int:
        """Samples in the unit of durations."""
        if self.lyapunov_time is None:
            return 1
        return durations.steps_per_lyapunov_time(1 / self.lyapunov_time, self.sampling_interval)

    def samples(self, name: str, duration: float) -> int:
        """Samples of a duration that is called so in messages: 1 at least."""
        samples = durations.steps(duration, self.unit)
        if samples < 1:
            counted = f"a Lyapunov time has {self.unit} samples"
            if self.lyapunov_time is None:
                counted = "durations are in samples unless lyapunov_time is given"
            raise ValueError(
                f"{name} is {duration:g}, which is {samples} samples; it must be 1 at least "
                f"({counted})"
            )
        return samples

    @property
    def times(self) -> list[float]:
        """Prediction times, each of them once."""
        return [*dict.fromkeys(float(time) for time in self.prediction_times)]

    def span(self, time: float) -> tuple[int, int]:
        """First and last step of the window at a prediction time, from the present."""
        start = self.samples("a prediction time", time)
        end = self.samples("the end of the window", time + self.window)
        if end <= start:
            raise ValueError(f"window is {self.window:g}, which is not a single sample")
        return start, end

    @cached_property
    def boundaries(self) -> tuple[int, ...]:
        """Steps at which windows begin and end, rising (`burstcast.forecasts.windows`)."""
        return tuple(sorted({step for time in self.times for step in self.span(time)}))

    def windows(self, time: float) -> tuple[int, int]:
        """First of the windows between boundaries that make up a prediction window; how many."""
        start, end = (self.boundaries.index(step) for step in self.span(time))
        return start, end - start


@dataclass(frozen=True)
class Events:
    """Crossings of a threshold in the prediction windows."""

    timing: EventTiming
    threshold: float  #: in units of the observable

    def weaknesses(self, observable: FloatArray) -> Iterator[str]:
        """Sentences about training series with few events, or with durations that are too short.

        ``observable``: ``(series, time)``, NaN where shorter series have ended.
        """
        events = self.number(observable)
        if events < FEW_EVENTS:
            number = f"is {events} event" if events == 1 else f"are {events} events"
            yield (
                f"there {number} in the training series, fewer than {FEW_EVENTS}: too few to learn "
                "from, and for a calibration; lower event_threshold, or give more or longer series"
            )
        exact = (self.timing.lyapunov_time or 1.0) / self.timing.sampling_interval
        if self.timing.lyapunov_time is not None and exact > _ROUGH * self.timing.unit:
            yield (
                f"a Lyapunov time of {exact:.3g} samples counts as {self.timing.unit}: durations "
                f"are {1 - self.timing.unit / exact:.0%} shorter than given (leave out "
                "lyapunov_time and give them in samples, or sample more finely)"
            )
        if self.timing.lyapunov_time is None:
            lengths, window = (~np.isnan(observable)).sum(axis=1), self.timing.window
            longest = observable[lengths.argmax(), : lengths.max()]
            steps = correlation_steps(longest[np.newaxis, :, np.newaxis])
            if window < steps:
                yield (
                    f"durations are in samples: a window of {window:g}, where the observable "
                    f"decorrelates within {steps} (give lyapunov_time or longer durations)"
                )

    def few_starts(self, points: ObservedPoints) -> Iterator[str]:
        """A sentence about a washout in which events leave too few starting points to learn from.

        ``points``: Starting points in training series.
        """
        quiet = self.quiet(points)
        followed = min(
            int((self.happened(points, time) & quiet).sum()) for time in self.timing.times
        )
        if len(quiet) and followed < FEW_EVENTS and quiet.mean() < _FEW_QUIET:
            yield (
                f"{int(quiet.sum())} of {len(quiet)} starting points have a washout without an "
                f"event, and an event follows {followed} of them, fewer than {FEW_EVENTS}: shorten "
                f"washout"
            )

    def shares(self, votes: Sequence[WindowSummaries]) -> ByTime:
        """Share of the votes for an event."""
        windows, times = self.timing.windows, self.timing.times
        return {time: share_of_votes(votes, *windows(time), self.threshold) for time in times}

    def valid(self, votes: Sequence[WindowSummaries]) -> ByTime:
        """Share of the votes that are valid forecasts."""
        windows, times = self.timing.windows, self.timing.times
        return {time: valid_votes(votes, *windows(time)) for time in times}

    def invalid(
        self, votes: Sequence[WindowSummaries], where: str, kind: Forecaster
    ) -> Iterator[str]:
        """A sentence about votes of which many are invalid forecasts of a kind."""
        share = max(float(1 - valid.mean()) for valid in self.valid(votes).values())
        yield from invalid_share(share, where, kind)

    def number(self, observable: FloatArray) -> int:
        """Number of events in series ``(series, time)``."""
        return int(upward_crossings(observable, self.threshold).sum())

    def happened(self, points: ObservedPoints, time: float) -> BoolArray:
        """Points that an event follows, ``(points,)``."""
        return crosses(points.truth, *self.timing.windows(time), self.threshold)

    def quiet(self, points: ObservedPoints) -> BoolArray:
        """Points without an event under way, ``(points,)``."""
        return np.asarray(points.seen.max(axis=1) < self.threshold)

    def labelled(self, points: ObservedPoints) -> LabelledPoints:
        """Points that a classifier learns from."""
        quiet = self.quiet(points)
        happened = np.stack([self.happened(points, time) for time in self.timing.times], axis=1)
        labelled = LabelledPoints(
            points.washouts[quiet], happened[quiet], points.points.series[quiet]
        )
        labelled.check(self.timing.times)
        return labelled

    def by_time(self, probabilities: FloatArray) -> ByTime:
        """Probabilities of a classifier, from ``(points, windows)``."""
        return dict(zip(self.timing.times, probabilities.T, strict=True))

    def calibrated(
        self, points: ObservedPoints, values: ByTime, prior: float | None
    ) -> tuple[dict[float, AlarmRule], dict[float, str]]:
        """Alarms at each prediction time, and sentences about those without skill.

        ``prior``: Weight of the prior of shares of votes; None: the values are probabilities.
        """
        alarms, findings = {}, {}
        for time in self.timing.times:
            outcomes = self.outcomes(points, values[time], time)
            if not outcomes.levels.size:
                raise ValueError(
                    f"no starting point is left to calibrate with: the observable reaches the "
                    f"event threshold {self.threshold:.4g} in every washout: shorten washout, or "
                    f"raise the threshold"
                )
            alarms[time] = _rule(outcomes, prior)
            if text := useless_votes(outcomes):
                findings[time] = f"prediction time {time:g}: {text}"
                continue
            score, permanent, skill = self._left_out_scores(points, values[time], time, prior)
            found = []
            if score <= permanent:
                found.append(
                    f"alarms have an F-score of {score:.2f}, no better than a permanent alarm "
                    f"({permanent:.2f})"
                )
            if skill < LITTLE_SKILL:
                found.append(
                    f"probabilities are no better than the base rate (Brier skill {skill:.2f})"
                )
            if found:
                where = "in training series that were left out"
                findings[time] = f"prediction time {time:g}: {where}, {' and '.join(found)}"
        return alarms, findings

    def _left_out_scores(
        self, points: ObservedPoints, values: FloatArray, time: float, prior: float | None
    ) -> tuple[float, float, float]:
        """Scores by rules that have not seen the series.

        F-score of the alarms, and of a permanent alarm; Brier skill of the probabilities.
        """
        series = points.points.series
        folds = min(_FOLDS, int(series.max()) + 1)
        outcomes = self.outcomes(points, values, time, series % folds)
        counts, error = np.zeros(4, dtype=np.int64), 0.0
        for fold in range(len(outcomes.points)):
            others = Outcomes(
                outcomes.levels,
                np.delete(outcomes.points, fold, axis=0).sum(axis=0),
                np.delete(outcomes.events, fold, axis=0).sum(axis=0),
            )
            rule = _rule(others, prior)
            left_out = Outcomes(outcomes.levels, outcomes.points[fold], outcomes.events[fold])
            raised = left_out.at(rule.calibration(outcomes.levels))
            counts += list(vars(counts_at(raised, rule.threshold)).values())
            error += float(np.nan_to_num(brier_score(raised)) * raised.points.sum())
        whole = outcomes.total()
        rate = float(base_rate(whole))
        return (
            float(np.nan_to_num(ContingencyTable(*counts).f_score)),
            permanent_f_score(whole),
            1 - error / (rate * (1 - rate) * float(whole.points.sum())),
        )

    def left_out(
        self, points: ObservedPoints, values: ByTime, prior: float | None
    ) -> dict[float, LeftOutForecasts]:
        """What calibrates at each prediction time, to compare kinds by.

        ``values``, ``prior``: As for `calibrated`.
        """
        quiet, where = self.quiet(points), points.points
        reach = self.timing.boundaries[-1]
        return {
            time: LeftOutForecasts(
                self.happened(points, time)[quiet],
                values[time][quiet],
                where.series[quiet],
                where.step[quiet],
                reach,
                prior,
            )
            for time in self.timing.times
        }

    def outcomes(
        self,
        points: ObservedPoints,
        values: FloatArray,
        time: float,
        blocks: IntArray | None = None,
    ) -> Outcomes:
        """Outcomes at each of the values that probabilities are made from.

        ``blocks``: Block of each point, counted from 0, by which outcomes are counted; None: their
        sums.
        """
        happened, quiet = self.happened(points, time), self.quiet(points)
        if blocks is None:
            whole = np.zeros(len(values), dtype=np.int64)
            return outcomes_by_series(values, happened, quiet, whole, 1).total()
        return outcomes_by_series(values, happened, quiet, blocks, int(blocks.max()) + 1)


def permanent_f_score(outcomes: Outcomes) -> float:
    """F-score of an alarm at each starting point; NaN without an event.

    ``outcomes``: Summed over series, ``(levels,)``.
    """
    events, points = int(outcomes.events.sum()), int(outcomes.points.sum())
    return 2 * events / (points + events) if events else float("nan")


def _rule(outcomes: Outcomes, prior: float | None) -> AlarmRule:
    calibration = logistic(outcomes) if prior is None else isotonic(outcomes, prior)
    return AlarmRule.chosen(outcomes, calibration)
