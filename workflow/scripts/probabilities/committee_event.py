"""One event as the committees of a case see it, with the probabilities that follow from it."""

from collections import ChainMap
from collections.abc import Sequence
from typing import Any

import numpy as np

from burstcast import durations
from burstcast.arrays import FloatArray
from burstcast.netcdf import read_netcdf, read_rows, variables_of
from burstcast.probability.committee_event import member_observables, see_event
from burstcast.probability.typical_event import typical_event
from burstcast_workflow.harness.job import Provenance, job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_json, write_netcdf
from burstcast_workflow.jobs.forecasters import read_forecaster
from burstcast_workflow.jobs.gather import gathered
from burstcast_workflow.jobs.probabilities import CALIBRATED, forecast_points, read_rules
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time


def _forecasts(
    paths: Sequence[str],
    time_unit: str | list[str],
    washout: FloatArray,
    reach: int,
    settings: Settings,
) -> dict[str, FloatArray]:
    """Observables that the members of each forecaster's ensemble forecast, by forecaster."""
    observable = system_of(settings).observable
    found: dict[str, FloatArray] = {}
    shared: Any = settings  # of all forecasters; the records have what is their own
    for record, path in gathered(settings["voters"], paths):
        own = ChainMap({**record["identity"], **record["settings"]}, shared)
        who = read_forecaster(path, own, time_unit)
        name = record["identity"]["forecaster"]
        found[name] = member_observables(who, observable, washout, reach)
    return found


@job
def event_of_committees(
    *,
    ensemble: str,
    evaluation_set: str,
    calibration: str,
    forecasters: list[str],
    forecasts: list[str],
    time_unit: str | list[str],
    committee_event: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write what happened, what all members forecast, votes, probabilities, alarm thresholds."""
    steps, threshold = lyapunov_time(settings, time_unit), settings["case.event_threshold"]
    points = forecast_points(settings, evaluation_set, forecasts)
    times, committees = settings["classification.prediction_times_lt"], settings["committees"]
    longest = max(times)
    point = typical_event(
        points.values(committees[0], longest, threshold),
        points.happened(longest, threshold),
        points.scored(threshold),
    )
    chances = np.full((3, len(committees), len(times)), np.nan)
    happened = [False] * len(times)
    true, observed = np.empty(0), np.empty(0)
    fans = [np.empty((0, 0)) for _ in committees]
    if point is not None:
        reach_lt = settings["classification.longest_prediction_time_lt"]
        reach = durations.steps(reach_lt + settings["classification.window_lt"], steps)
        washout = read_netcdf(evaluation_set, "washout")["washout"][point]
        observed = system_of(settings).observable(washout.T)
        row = settings["case.training.series"] + int(points.data["series"][point])
        now = int(points.data["step"][point])
        series = read_rows(ensemble, "observable", row, row + 1)[0]
        true = series[now + 1 - len(washout) : now + 1 + reach]
        found = _forecasts(forecasters, time_unit, washout, reach, settings)
        fans = [np.concatenate([found[name] for name in one["forecasters"]]) for one in committees]
        happened = [bool(points.happened(time, threshold)[point]) for time in times]
        chosen = read_json(calibration)
        for number, committee in enumerate(committees):
            for column, time in enumerate(times):
                rule = read_rules(chosen, committee, time)[CALIBRATED]
                votes = points.values(committee, time, threshold)[point : point + 1]
                probability = rule.calibration(votes)
                chances[:, number, column] = votes[0], probability[0], rule.threshold
    event = see_event(true, observed, fans, times, happened, chances, steps)
    kinds = [committee["keys"]["forecaster"] for committee in committees]
    whose = {"committees": " ".join(kinds)}
    which = {"point": -1 if point is None else point}
    write_netcdf(committee_event, variables_of(event), {**provenance, **whose, **which})
