"""What the stages of probabilities share: forecasts of all who raise alarms, and calibrations."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from burstcast import random_streams
from burstcast.arrays import BoolArray, FloatArray, IntArray
from burstcast.forecast.windows import WindowSummaries, crosses
from burstcast.probability.alarm_rule import AlarmRule
from burstcast.probability.outcomes import Outcomes, outcomes_by_series
from burstcast.probability.votes import share_of_votes
from burstcast.resampling import bootstrap_weights
from burstcast_workflow.harness.storage import read_json, read_netcdf
from burstcast_workflow.jobs.gather import gathered

Settings = Mapping[str, Any]
Record = Mapping[str, Any]

CALIBRATED, VOTES = "calibrated", "votes"
"""What tables call calibrated probabilities, and shares of votes as they are."""


@dataclass(frozen=True)
class ForecastPoints:
    """Starting points of a case, what followed, and what was forecast.

    Attributes
    ----------
    data
        Variables of the points (`burstcast_workflow.jobs.point_sets`).
    forecasts
        Window summaries by the identifier of the forecaster.
    ensembles
        Those of each member, where a forecaster tells an ensemble, likewise.
    windows, resolution_lt
        How many windows make up a prediction window, and how long each is in Lyapunov times.
    """

    data: Mapping[str, Any]
    forecasts: Mapping[str, WindowSummaries]
    ensembles: Mapping[str, Sequence[WindowSummaries]]
    windows: int
    resolution_lt: float

    @property
    def series(self) -> int:
        """Number of series."""
        return int(self.data["series"].max()) + 1

    def scored(self, event_threshold: float) -> BoolArray:
        """Points at which no event is under way."""
        return np.asarray(self.data["washout_maximum"] < event_threshold)

    def values(
        self, alarm: Record, prediction_time_lt: float, event_threshold: float
    ) -> FloatArray:
        """What an alarm is raised by: a share of votes, or a baseline's score; ``(points,)``."""
        members = [self.forecasts[name] for name in alarm["members"]]
        members += [one for name in alarm["ensembles"] for one in self.ensembles[name]]
        if members:
            first = self._first(prediction_time_lt)
            return share_of_votes(members, first, self.windows, event_threshold)
        now: FloatArray = self.data["observable_now"]
        return now if alarm["alarm"] == "observable_now" else np.zeros(len(now))

    def happened(self, prediction_time_lt: float, event_threshold: float) -> BoolArray:
        """Points that an event follows, ``(points,)``."""
        truth = WindowSummaries(self.data["first"], self.data["largest"])
        return crosses(truth, self._first(prediction_time_lt), self.windows, event_threshold)

    def outcomes(
        self, alarm: Record, prediction_time_lt: float, event_threshold: float
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


def forecast_points(
    settings: Settings,
    point_set: str,
    forecasts: Mapping[str, str],
    ensembles: Mapping[str, str],
) -> ForecastPoints:
    """Read the points of a case, and the forecasts from them by the forecaster's identifier."""
    resolution = settings["classification.resolution_lt"]
    names = ("series", "step", "observable_now", "washout_maximum", "first", "largest")
    found = {name: read_netcdf(path, "first", "largest") for name, path in forecasts.items()}
    members = {name: read_netcdf(path, "first", "largest") for name, path in ensembles.items()}
    return ForecastPoints(
        read_netcdf(point_set, *names),
        {name: WindowSummaries(data["first"], data["largest"]) for name, data in found.items()},
        {
            name: [
                WindowSummaries(*pair) for pair in zip(data["first"], data["largest"], strict=True)
            ]
            for name, data in members.items()
        },
        round(settings["classification.window_lt"] / resolution),
        resolution,
    )


def forecasters_of(rows: Sequence[Record], paths: Sequence[str]) -> dict[str, str]:
    """Files of one case by the identifier of the forecaster (`gathered`)."""
    return {record["identity"]["forecaster"]: path for record, path in gathered(rows, paths)}


@dataclass(frozen=True)
class CaseProbabilities:
    """Forecasts of a case's test series, with what was chosen on the calibration series.

    Attributes
    ----------
    case, event_threshold
        The case.
    steps_per_lyapunov_time
        Of the case.
    points
        Of the evaluation set.
    rules
        Records of rules by alarm, factor of the event threshold, prediction time, calibration.
    alarms
        Records of all who raise alarms.
    random_seed, resamples
        Of the bootstrap.
    """

    case: str
    event_threshold: float
    steps_per_lyapunov_time: int
    points: ForecastPoints
    rules: Mapping[str, Mapping[str, Mapping[str, Mapping[str, Record]]]]
    alarms: Sequence[Record]
    random_seed: int
    resamples: int

    def rule(self, alarm: Record, prediction_time_lt: float, factor: float = 1.0) -> AlarmRule:
        """How an alarm is raised: by calibrated probabilities."""
        by_name = self.rules[alarm["alarm"]][f"{factor:g}"][f"{prediction_time_lt:g}"]
        return AlarmRule.restore(by_name[CALIBRATED])

    def probabilities(
        self, alarm: Record, prediction_time_lt: float, factor: float = 1.0
    ) -> Iterator[tuple[str, Outcomes, float]]:
        """Outcomes by probability and series: of calibrated probabilities, and of votes.

        Yields
        ------
        `CALIBRATED` or `VOTES`, outcomes, and the probability from which on alarms are raised.
        """
        raw = self.points.outcomes(alarm, prediction_time_lt, factor * self.event_threshold)
        by_name = self.rules[alarm["alarm"]][f"{factor:g}"][f"{prediction_time_lt:g}"]
        for name, record in by_name.items():
            rule = AlarmRule.restore(record)
            yield name, raw.at(rule.calibration(raw.levels)), rule.threshold

    def weights(self, prediction_time_lt: float) -> IntArray:
        """Weights of the series in each resample: the same for all who are compared."""
        generator = self.stream("bootstrap", prediction_time_lt)
        return bootstrap_weights(self.points.series, self.resamples, generator)

    def stream(self, purpose: str, prediction_time_lt: float, *names: str) -> np.random.Generator:
        """Source of random numbers for one prediction time."""
        return random_streams.stream(
            self.random_seed, purpose, self.case, str(float(prediction_time_lt)), *names
        )


def case_probabilities(
    settings: Settings,
    forecasts: Sequence[str],
    member_forecasts: Sequence[str],
    evaluation_set: str,
    calibration: str,
) -> CaseProbabilities:
    """Read what a case's tables of probabilities are made from.

    Parameters
    ----------
    settings
        Of the job, with ``rows`` of the forecasters, ``ensemble_rows`` of those that tell an
        ensemble, and ``alarms``.
    forecasts, member_forecasts, evaluation_set, calibration
        Inputs of the job.
    """
    chosen = read_json(calibration)
    return CaseProbabilities(
        case=settings["case"],
        event_threshold=settings["case.event_threshold"],
        steps_per_lyapunov_time=chosen["steps_per_lyapunov_time"],
        points=forecast_points(
            settings,
            evaluation_set,
            forecasters_of(settings["rows"], forecasts),
            forecasters_of(settings["ensemble_rows"], member_forecasts),
        ),
        rules=chosen["alarms"],
        alarms=settings["alarms"],
        random_seed=settings["random_seed"],
        resamples=settings["bootstrap.resamples"],
    )
