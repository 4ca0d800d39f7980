"""What the stages of probabilities share: sources of alarms, their forecasts, and calibrations.

A committee consists of the members of ensembles: of all networks of a size and strategy, each of
which is one member, or of one forecaster that provides an ensemble (a filter, analogues).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from burstcast import random_streams
from burstcast.arrays import BoolArray, FloatArray, IntArray
from burstcast.files.netcdf import read_netcdf
from burstcast.forecast.windows import WindowForecasts, WindowSummaries, crosses
from burstcast.probability.alarm_rule import AlarmRule
from burstcast.probability.outcomes import Outcomes, outcomes_by_series
from burstcast.probability.votes import share_of_votes
from burstcast.statistics.resampling import bootstrap_weights
from burstcast_workflow.campaign.identifiers import ForecasterName, parsed
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_json
from burstcast_workflow.jobs.gather import case_keys, origins

BASELINES = ("climatology", "observable_now")
"""Alarms without a forecast: by the base rate alone, and by the observable at this moment."""
CALIBRATED, VOTES = "calibrated", "votes"
"""What tables call calibrated probabilities, and shares of votes as they are."""


@dataclass(frozen=True)
class AlarmSource:
    """Source of alarms in a case.

    Attributes
    ----------
    name
        Its name: that of its forecaster, ``esn-N1000-RV-committee``,
        ``quadratic_filtered-committee``, or one of `BASELINES`.
    forecasters
        Identifiers of the forecasters that vote; none for baselines.
    """

    name: ForecasterName
    forecasters: tuple[str, ...] = ()

    @property
    def identifier(self) -> str:
        """Its name in tables and files."""
        return self.name.identifier

    @property
    def committee(self) -> bool:
        """Whether all members of the forecasters' ensembles vote, not their single forecasts."""
        return self.name.role == "committee"

    @property
    def compared(self) -> bool:
        """Whether it is compared with others: all but the single networks of an ensemble."""
        return self.name.seed is None


def alarm_sources(forecasts: Mapping[str, WindowForecasts]) -> list[AlarmSource]:
    """All sources of alarms in a case: baselines, forecasters, then committees.

    Parameters
    ----------
    forecasts
        Forecasts by the identifier of the forecaster.
    """
    groups: dict[ForecasterName, list[str]] = {}
    for name in forecasts:
        groups.setdefault(replace(parsed(name), seed=None), []).append(name)
    committees = [
        AlarmSource(replace(common, role="committee"), tuple(voters))
        for common, voters in groups.items()
        if len(voters) > 1 or forecasts[voters[0]].member_first.size
    ]
    return [
        *(AlarmSource(ForecasterName(name)) for name in BASELINES),
        *(AlarmSource(parsed(name), (name,)) for name in forecasts),
        # committees of several networks come first
        *sorted(committees, key=lambda source: len(source.forecasters) == 1),
    ]


@dataclass(frozen=True)
class ForecastPoints:
    """Starting points of a case, what followed, and what was forecast.

    Attributes
    ----------
    data
        Variables of the points (`burstcast_workflow.jobs.forecasts`).
    forecasts
        Forecasts from the points, by the identifier of the forecaster.
    windows, resolution_lt
        How many windows make up a prediction window, and how long each is in Lyapunov times.
    """

    data: Mapping[str, Any]
    forecasts: Mapping[str, WindowForecasts]
    windows: int
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

    def values(
        self, alarm: AlarmSource, prediction_time_lt: float, event_threshold: float
    ) -> FloatArray:
        """What an alarm is raised by: a share of votes, or a baseline's score; ``(points,)``."""
        forecasts = [self.forecasts[name] for name in alarm.forecasters]
        if forecasts:
            members = [member for one in forecasts for member in one.members]
            voters = members if alarm.committee else forecasts
            first = self._first(prediction_time_lt)
            return share_of_votes(voters, first, self.windows, event_threshold)
        now: FloatArray = self.data["observable_now"]
        return now if alarm.identifier == "observable_now" else np.zeros(len(now))

    def happened(self, prediction_time_lt: float, event_threshold: float) -> BoolArray:
        """Points that an event follows, ``(points,)``."""
        truth = WindowSummaries(self.data["first"], self.data["largest"])
        return crosses(truth, self._first(prediction_time_lt), self.windows, event_threshold)

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

    def _first(self, prediction_time_lt: float) -> int:
        return round(prediction_time_lt / self.resolution_lt) - 1


def forecast_points(settings: Settings, point_set: str, forecasts: Sequence[str]) -> ForecastPoints:
    """Read the starting points of a case, and the forecasts from them: inputs of the job."""
    resolution = settings["classification.resolution_lt"]
    found = {one.name.identifier: _read_forecasts(one.path) for one in origins(forecasts)}
    names = ("series", "step", "observable_now", "washout_maximum", "first", "largest")
    windows = round(settings["classification.window_lt"] / resolution)
    return ForecastPoints(read_netcdf(point_set, *names), found, windows, resolution)


def _read_forecasts(path: str) -> WindowForecasts:
    """Read forecasts that `burstcast_workflow.jobs.forecasts.write_forecasts` wrote."""
    found = read_netcdf(path)
    none = np.empty((len(found["first"]), 0, found["first"].shape[1]))
    return WindowForecasts(**{"member_first": none, "member_largest": none, **found})


def read_rules(
    chosen: Mapping[str, Any], alarm: AlarmSource, prediction_time_lt: float, factor: float = 1.0
) -> dict[str, AlarmRule]:
    """Rules of an alarm: by `CALIBRATED` probabilities, and, if it has any, by `VOTES`.

    Parameters
    ----------
    chosen
        Content of ``calibration.json``.
    alarm
        Source of the alarms.
    prediction_time_lt, factor
        Prediction time, and the event threshold in those of the case.
    """
    found = chosen["alarms"][alarm.identifier][f"{factor:g}"][f"{prediction_time_lt:g}"]
    return {name: AlarmRule.restore(record) for name, record in found.items()}


@dataclass(frozen=True)
class CaseProbabilities:
    """Forecasts of a case's test series, with what was chosen on the calibration series.

    Attributes
    ----------
    settings
        Of the job.
    points
        Of the evaluation set.
    chosen
        Content of ``calibration.json``.
    """

    settings: Settings
    points: ForecastPoints
    chosen: Mapping[str, Any]

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
        alarm, *_ = self.alarms
        times = self.settings["classification.prediction_times_lt"]
        return bool(read_rules(self.chosen, alarm, times[0])[CALIBRATED].calibration.values.size)

    def keys(self, alarm: AlarmSource) -> dict[str, Any]:
        """Key columns of a source of alarms in tables."""
        return {**case_keys(self.settings), **alarm.name.keys, "alarm": alarm.identifier}

    def probabilities(
        self, alarm: AlarmSource, prediction_time_lt: float, factor: float = 1.0
    ) -> dict[str, tuple[Outcomes, float]]:
        """Outcomes by probability and series, and the probability from which on alarms are raised.

        By `CALIBRATED`, and by `VOTES` where there are any.
        """
        threshold = factor * self.settings["case.event_threshold"]
        raw = self.points.outcomes(alarm, prediction_time_lt, threshold)
        return {
            name: (raw.at(rule.calibration(raw.levels)), rule.threshold)
            for name, rule in read_rules(self.chosen, alarm, prediction_time_lt, factor).items()
        }

    def weights(self, prediction_time_lt: float) -> IntArray:
        """Weights of the series in each resample: the same for all who are compared."""
        generator = self.stream("bootstrap", prediction_time_lt)
        resamples = self.settings["bootstrap.resamples"]
        return bootstrap_weights(self.points.series, resamples, generator)

    def stream(self, purpose: str, prediction_time_lt: float, *names: str) -> np.random.Generator:
        """Source of random numbers for one prediction time."""
        seed, case = self.settings["random_seed"], self.settings["case"]
        return random_streams.stream(seed, purpose, case, str(float(prediction_time_lt)), *names)


def case_probabilities(
    settings: Settings, forecasts: Sequence[str], evaluation_set: str, calibration: str
) -> CaseProbabilities:
    """Read what a case's tables of probabilities are made from, the inputs of these jobs."""
    points = forecast_points(settings, evaluation_set, forecasts)
    return CaseProbabilities(settings, points, read_json(calibration))
