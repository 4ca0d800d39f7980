"""Starting points of a case: observations, true continuations, forecasts, outcomes.

An alarm source is a forecaster, a committee, or a baseline without forecasts. A committee votes
with all networks of a size and strategy, or with the members of one ensemble.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self, TypeAlias

import numpy as np

from burstcast.base import durations
from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.base.names import ForecasterName, parsed
from burstcast.base.series_lengths import series_lengths
from burstcast.data.starting_points import SeriesPoints, segments, starting_points
from burstcast.forecasters._event_classifier import LabelledPoints, known_features
from burstcast.forecasts.probabilities import EventProbabilities
from burstcast.forecasts.scores import Outcomes, outcomes_by_series
from burstcast.forecasts.windows import (
    WindowForecasts,
    WindowSummaries,
    crosses,
    share_of_votes,
    summarise,
)

BASELINES = ("climatology", "observable_now")
"""Alarms without a forecast: by the base rate alone, and by the observable at this moment."""


@dataclass(frozen=True)
class AlarmSource:
    """Source of alarms in a case."""

    #: its name: its forecaster's, ``esn-N1000-RV-committee``, ``quadratic_filtered-committee``, or
    #: one of `BASELINES`
    name: ForecasterName
    #: identifiers of the forecasters that vote; none for baselines
    forecasters: tuple[str, ...] = ()

    @property
    def identifier(self) -> str:
        """Name of the source of alarms in tables and files."""
        return self.name.identifier

    @property
    def committee(self) -> bool:
        """Whether all members of the forecasters' ensembles vote, not their single forecasts."""
        return self.name.role == "committee"

    @property
    def compared(self) -> bool:
        """Whether it is compared with others: all but the single networks of an ensemble."""
        return self.name.seed is None


Forecasts: TypeAlias = Mapping[str, WindowForecasts | EventProbabilities]
"""Forecasts of a case by the identifier of the forecaster."""


def alarm_sources(forecasts: Forecasts) -> list[AlarmSource]:
    """All sources of alarms in a case: baselines, forecasters, then committees."""
    groups: dict[ForecasterName, list[str]] = {}
    for name in forecasts:
        groups.setdefault(replace(parsed(name), seed=None), []).append(name)
    committees = []
    for common, voters in groups.items():
        first = forecasts[voters[0]]
        if len(voters) > 1 or (isinstance(first, WindowForecasts) and first.member_first.size):
            committees.append(AlarmSource(replace(common, role="committee"), tuple(voters)))
    committees.sort(key=lambda source: len(source.forecasters) == 1)  # several networks first
    baselines = [AlarmSource(ForecasterName(name)) for name in BASELINES]
    return baselines + [AlarmSource(parsed(name), (name,)) for name in forecasts] + committees


@dataclass(frozen=True)
class ObservedPoints:
    """Starting points with washouts and true continuations."""

    points: SeriesPoints
    #: observed states up to and including each point, ``(points, steps, component)``
    washouts: FloatArray
    seen: FloatArray  #: observed observable of the washouts, ``(points, steps)``
    truth: WindowSummaries  #: window summaries of the true observable

    def of_series(self, rows: IntArray) -> Self:
        """Points in some of the series."""
        here = np.isin(self.points.series, rows)
        points = replace(self.points, series=self.points.series[here], step=self.points.step[here])
        truth = {name: values[here] for name, values in vars(self.truth).items()}
        return type(self)(points, self.washouts[here], self.seen[here], WindowSummaries(**truth))


def observed_points(
    observed: FloatArray,
    true_observable: FloatArray,
    observable: Callable[[FloatArray], FloatArray],
    *,
    spacing: int,
    washout: int,
    boundaries: tuple[int, ...],
) -> ObservedPoints:
    """Evenly spaced starting points (`starting_points`) of observed series.

    ``observed``: ``(series, time, component)``. ``true_observable``: ``(series, time)``, which
    forecasts are scored against.
    """
    series, length = true_observable.shape
    lengths = series_lengths(observed)
    points = starting_points(series, length, spacing, washout, boundaries[-1], lengths=lengths)
    washouts = segments(observed, points, washout - 1, 0)
    return ObservedPoints(
        points,
        washouts,
        observable(washouts.transpose(2, 0, 1)),
        summarise(segments(true_observable, points, 0, boundaries[-1])[:, 1:].T, boundaries),
    )


@dataclass(frozen=True)
class ForecastPoints:
    """Starting points of a case, with outcomes and forecasts."""

    #: variables of the points (`burstcast.forecasts.points.point_variables`)
    data: Mapping[str, Any]
    forecasts: Forecasts  #: forecasts from the points, by the identifier of the forecaster
    #: window_lt, resolution_lt: length of a prediction window, and of the windows that make it up,
    #: in Lyapunov times
    window_lt: float
    resolution_lt: float

    @cached_property
    def alarms(self) -> list[AlarmSource]:
        """All sources of alarms (`alarm_sources`)."""
        return alarm_sources(self.forecasts)

    @property
    def series(self) -> int:
        """Number of series."""
        return int(self.data["series"].max()) + 1

    def scored(self, event_threshold: float) -> BoolArray:
        """Points at which no event is under way."""
        return np.asarray(self.data["washout_maximum"] < event_threshold)

    def classifier(self, alarm: AlarmSource) -> EventProbabilities | None:
        """Probabilities that a classifier gives; None where alarms come from anything else."""
        forecasts = [self.forecasts[name] for name in alarm.forecasters]
        return (
            forecasts[0]
            if len(forecasts) == 1 and isinstance(forecasts[0], EventProbabilities)
            else None
        )

    def values(
        self, alarm: AlarmSource, prediction_time_lt: float, event_threshold: float
    ) -> FloatArray:
        """Votes, probabilities, or scores of a baseline, that raise alarms, ``(points,)``."""
        if classifier := self.classifier(alarm):
            return classifier.at(prediction_time_lt, event_threshold)
        voters: list[WindowSummaries] = []
        for name in alarm.forecasters:
            forecast = self.forecasts[name]
            if isinstance(forecast, WindowForecasts):
                voters += forecast.members if alarm.committee else [forecast]
        if voters:
            return share_of_votes(voters, *self.windows(prediction_time_lt), event_threshold)
        now: FloatArray = self.data["observable_now"]
        return now if alarm.identifier == "observable_now" else np.zeros(len(now))

    def happened(self, prediction_time_lt: float, event_threshold: float) -> BoolArray:
        """Points that an event follows, ``(points,)``."""
        truth = WindowSummaries(self.data["first"], self.data["largest"])
        return crosses(truth, *self.windows(prediction_time_lt), event_threshold)

    def labelled(
        self,
        prediction_times_lt: Sequence[float],
        event_threshold: float,
        exogenous: FloatArray | None = None,
    ) -> LabelledPoints:
        """Points without an event under way, labelled for training a classifier."""
        times, scored = prediction_times_lt, self.scored(event_threshold)
        happened = np.stack([self.happened(time, event_threshold) for time in times], axis=1)
        return LabelledPoints(
            self.data["washout"][scored],
            happened[scored],
            self.data["series"][scored],
            None if exogenous is None else exogenous[scored],
        )

    def exogenous_features(
        self, prediction_times_lt: Sequence[float], steps_per_lyapunov_time: int
    ) -> FloatArray | None:
        """Features of what is known in advance (`known_features`); None where nothing is."""
        if "parameter" not in self.data:
            return None
        unit, length = steps_per_lyapunov_time, self.window_lt
        windows = [
            (durations.steps(time, unit), durations.steps(time + length, unit))
            for time in prediction_times_lt
        ]
        now = self.data["washout"].shape[1] - 2
        return known_features(self.data["parameter"], now, windows)

    def outcomes(
        self,
        alarm: AlarmSource,
        prediction_time_lt: float,
        event_threshold: float,
        among: BoolArray | None = None,
    ) -> Outcomes:
        """Outcomes by the values that alarms are raised by, ``(series, levels)``.

        ``among``: Points that count, if no event is under way there; None: all.
        """
        scored = self.scored(event_threshold)
        return outcomes_by_series(
            self.values(alarm, prediction_time_lt, event_threshold),
            self.happened(prediction_time_lt, event_threshold),
            scored if among is None else scored & among,
            self.data["series"],
            self.series,
        )

    def windows(self, prediction_time_lt: float) -> tuple[int, int]:
        """First of the windows of a prediction window, and how many it has."""
        first = round(prediction_time_lt / self.resolution_lt) - 1
        return first, round(self.window_lt / self.resolution_lt)
