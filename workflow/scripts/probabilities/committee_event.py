"""One event as the committees of a case see it, with the probabilities that follow from it."""

from collections import ChainMap
from collections.abc import Sequence
from typing import Any

import numpy as np

from burstcast import durations
from burstcast.arrays import FloatArray
from burstcast.probability import members
from burstcast.probability.alarm_rule import AlarmRule
from burstcast.probability.typical_event import typical_event
from burstcast_workflow.harness.job import Provenance, run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import (
    Variable,
    read_json,
    read_netcdf,
    read_rows,
    write_netcdf,
)
from burstcast_workflow.jobs.forecasters import read_forecaster
from burstcast_workflow.jobs.gather import gathered
from burstcast_workflow.jobs.members import with_members
from burstcast_workflow.jobs.probabilities import (
    CALIBRATED,
    forecast_points,
    forecasters_of,
)
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time


def see_event(
    *,
    ensemble: str,
    evaluation_set: str,
    calibration: str,
    forecasters: list[str],
    forecasts: list[str],
    member_forecasts: list[str],
    time_unit: str | list[str],
    committee_event: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write what happened, what all members forecast, votes, probabilities, alarm thresholds."""
    steps, threshold = lyapunov_time(settings, time_unit), settings["case.event_threshold"]
    points = forecast_points(
        settings,
        evaluation_set,
        forecasters_of(settings["rows"], forecasts),
        forecasters_of(settings["ensemble_rows"], member_forecasts),
    )
    times = settings["classification.prediction_times_lt"]
    committees = settings["committees"]
    longest = max(times)
    point = typical_event(
        points.values(committees[0], longest, threshold),
        points.happened(longest, threshold),
        points.scored(threshold),
    )
    chosen = [] if point is None else [point]
    washouts = read_netcdf(evaluation_set, "washout")["washout"][chosen]
    reach_lt = settings["classification.longest_prediction_time_lt"]
    reach = durations.steps(reach_lt + settings["classification.window_lt"], steps)
    before = washouts.shape[1] - 1
    length = before + 1 + reach if chosen else 0
    true, observed = np.full((2, length), np.nan)
    if point is not None:
        row = settings["case.training.series"] + int(points.data["series"][point])
        first = int(points.data["step"][point]) - before
        true = read_rows(ensemble, "observable", row, row + 1)[0, first : first + length]
        observed[: before + 1] = system_of(settings).observable(washouts[0].T)
    found = _forecasts(forecasters, time_unit, washouts, reach, settings)
    fans = [
        (number, fan)
        for number, committee in enumerate(committees)
        for name in (*committee["members"], *committee["ensembles"])
        for fan in found[name, bool(committee["ensembles"])]
    ]
    drawn = np.full((len(fans), length), np.nan)
    for line, (_, fan) in zip(drawn, fans, strict=True):
        line[before + 1 :] = fan
    chances = np.full((3, len(committees), len(times)), np.nan)
    rules = read_json(calibration)["alarms"]
    for number, committee in enumerate(committees):
        for column, time in enumerate(times):
            if point is not None:
                rule = AlarmRule.restore(rules[committee["alarm"]]["1"][f"{time:g}"][CALIBRATED])
                votes = points.values(committee, time, threshold)[point : point + 1]
                chances[:, number, column] = (
                    votes[0],
                    rule.calibration(votes)[0],
                    rule.threshold,
                )
    happened = [
        point is not None and bool(points.happened(time, threshold)[point]) for time in times
    ]
    write_netcdf(
        committee_event,
        {
            "time_lt": Variable(
                ("time",),
                np.arange(length) / steps - before / steps,
                "1",
                "time after the starting point in Lyapunov times",
            ),
            "true": Variable(("time",), true, "1", "true observable"),
            "observed": Variable(("time",), observed, "1", "observable of what was observed"),
            "prediction_time_lt": Variable(
                ("window",), np.array(times, dtype=np.float64), "1", "beginning of each window"
            ),
            "happened": Variable(
                ("window",), np.array(happened, dtype=bool), "1", "whether an event began in it"
            ),
            "committee": Variable(
                ("member",),
                np.array([number for number, _ in fans], dtype=np.int64),
                "1",
                "committee of each member",
            ),
            "forecast": Variable(("member", "time"), drawn, "1", "forecast observable"),
            **{
                name: Variable(("committees", "window"), values, "1", description)
                for name, values, description in zip(
                    ("votes", "probability", "alarm_threshold"),
                    chances,
                    (
                        "share of the members that forecast an event",
                        "calibrated probability of an event",
                        "probability from which on an alarm is raised",
                    ),
                    strict=True,
                )
            },
        },
        {
            **provenance,
            "committees": " ".join(committee["keys"]["forecaster"] for committee in committees),
            "point": -1 if point is None else point,
        },
    )


def _forecasts(
    paths: Sequence[str],
    time_unit: str | list[str],
    washouts: FloatArray,
    reach: int,
    settings: Settings,
) -> dict[tuple[str, bool], list[FloatArray]]:
    """Forecast observables ``(steps,)`` by forecaster, of itself and of its ensemble's members."""
    observable = system_of(settings).observable
    found: dict[tuple[str, bool], list[FloatArray]] = {}
    shared: Any = settings  # of all forecasters; the records have what is their own
    for record, path in gathered(settings["who"], paths):
        own = ChainMap({**record["identity"], **record["settings"]}, shared)
        who = read_forecaster(path, own, time_unit)
        key = record["identity"]["forecaster"], record["by_members"]
        found[key] = []
        for washout in washouts:
            given = np.ascontiguousarray(washout[:, :, np.newaxis])
            if record["by_members"]:
                outputs = members.member_forecasts(with_members(who), given, reach)[..., 0]
            else:
                outputs, _ = who.advance(who.start(given), reach)
            values = observable(outputs.transpose(1, 0, 2))
            found[key] += list(values.T)
    return found


if __name__ == "__main__":
    run_job(snakemake, see_event)  # noqa: F821 - Snakemake puts it there
