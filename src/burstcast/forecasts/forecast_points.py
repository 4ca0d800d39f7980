"""Starting points of a case: sources of alarms, their values, and the outcomes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from burstcast.base import durations
from burstcast.base.arrays import BoolArray, FloatArray
from burstcast.forecasters._event_classifier import LabelledPoints, known_features
from burstcast.forecasts.alarm_sources import AlarmSource, Forecasts, alarm_sources
from burstcast.forecasts.event_probabilities import EventProbabilities
from burstcast.forecasts.outcomes import Outcomes, outcomes_by_series
from burstcast.forecasts.windows import (
    WindowForecasts,
    WindowSummaries,
    crosses,
    share_of_votes,
)


@dataclass(frozen=True)
class ForecastPoints:
    """Starting points of a case, with outcomes and forecasts."""

    #: variables of the points (`burstcast.forecasts.forecast_files.point_variables`)
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
        self, alarm: AlarmSource, prediction_time_lt: float, event_threshold: float
    ) -> Outcomes:
        """Outcomes by the values that alarms are raised by, ``(series, levels)``."""
        return outcomes_by_series(
            self.values(alarm, prediction_time_lt, event_threshold),
            self.happened(prediction_time_lt, event_threshold),
            self.scored(event_threshold),
            self.data["series"],
            self.series,
        )

    def windows(self, prediction_time_lt: float) -> tuple[int, int]:
        """First of the windows of a prediction window, and how many it has."""
        first = round(prediction_time_lt / self.resolution_lt) - 1
        return first, round(self.window_lt / self.resolution_lt)
