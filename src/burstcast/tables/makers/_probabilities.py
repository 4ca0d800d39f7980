"""Inputs of tables of probabilities: forecasts with calibrations and thresholds."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from burstcast.base import random_streams
from burstcast.base.arrays import BoolArray, IntArray
from burstcast.base.declared import at, gathered, read
from burstcast.base.resampling import bootstrap_weights
from burstcast.forecasts.alarms import CALIBRATED, AlarmRule, rules_of
from burstcast.forecasts.forecast_files import forecasts_from
from burstcast.forecasts.points import AlarmSource, ForecastPoints
from burstcast.forecasts.scores import Outcomes
from burstcast.tables.makers.registry import Gathered


@dataclass(frozen=True)
class CaseProbabilities:
    """Forecasts of a case's test series, with choices made on the calibration series."""

    points: ForecastPoints  #: points of the evaluation set
    chosen: Mapping[str, Any]  #: content of ``calibration.json``
    case: str
    root_seed: int
    event_threshold: float
    times: Sequence[float]
    resamples: int
    confidence: float

    @property
    def alarms(self) -> list[AlarmSource]:
        """All sources of alarms."""
        return self.points.alarms

    @property
    def compared(self) -> list[AlarmSource]:
        """Committees, and all other sources of alarms but single networks."""
        return [alarm for alarm in self.alarms if alarm.compared]

    @property
    def is_calibrated(self) -> bool:
        """Whether there were forecasts to calibrate with: the same for all sources of alarms."""
        rules = self.rules(self.alarms[0], self.times[0])
        return bool(rules[CALIBRATED].calibration.values.size)

    def keys(self, alarm: AlarmSource) -> dict[str, Any]:
        """Key columns of a source of alarms in tables."""
        return {**alarm.name.keys, "alarm": alarm.identifier}

    def rules(self, alarm: AlarmSource, prediction_time_lt: float) -> dict[str, AlarmRule]:
        """Rules of an alarm (`burstcast.forecasts.alarms.rules_of`)."""
        return rules_of(self.chosen, alarm.identifier, prediction_time_lt)

    def probabilities(
        self, alarm: AlarmSource, prediction_time_lt: float, among: BoolArray | None = None
    ) -> dict[str, tuple[Outcomes, float]]:
        """Outcomes by probability and series, and the alarm threshold.

        By what they are called in tables (`rules`). ``among``: Points that count; None: all.
        """
        raw = self.points.outcomes(alarm, prediction_time_lt, self.event_threshold, among)
        return {
            name: (raw.at(rule.calibration(raw.levels)), rule.threshold)
            for name, rule in self.rules(alarm, prediction_time_lt).items()
        }

    def weights(self, prediction_time_lt: float) -> IntArray:
        """Weights of the series in each resample, common to all compared forecasters."""
        generator = self.stream("bootstrap", prediction_time_lt)
        return bootstrap_weights(self.points.series, self.resamples, generator)

    def stream(self, purpose: str, prediction_time_lt: float, *names: str) -> np.random.Generator:
        """Source of random numbers for one prediction time."""
        time = str(float(prediction_time_lt))
        return random_streams.stream(self.root_seed, purpose, self.case, time, *names)


def case_probabilities(
    *,
    forecasts: Sequence[Gathered] = gathered("forecasters/forecast.nc"),
    evaluation_set: Mapping[str, Any] = read(
        "case/evaluation_set.nc", "series step observable_now washout_maximum first largest"
    ),
    calibration: Mapping[str, Any] = read("case/calibration.json"),
    case: str = at("case"),
    root_seed: int = at("random_seed"),
    event_threshold: float = read("case/event_threshold.json:event_threshold"),
    times: Sequence[float] = at("classification.prediction_times_lt"),
    window_lt: float = at("classification.window_lt"),
    resolution_lt: float = at("classification.resolution_lt"),
    resamples: int = at("bootstrap.resamples"),
    confidence: float = at("bootstrap.confidence"),
) -> CaseProbabilities:
    """Forecasts of a case's test series, with choices made on the calibration series."""
    by_identifier = {each.name.identifier: forecasts_from(each.content) for each in forecasts}
    points = ForecastPoints(evaluation_set, by_identifier, window_lt, resolution_lt)
    scored = case, root_seed, event_threshold, times, resamples, confidence
    return CaseProbabilities(points, calibration, *scored)
