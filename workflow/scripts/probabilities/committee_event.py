"""One event as the committees of a case see it, with the probabilities that follow from it."""

from collections.abc import Sequence

import numpy as np

from burstcast import durations
from burstcast.arrays import FloatArray
from burstcast.files.netcdf import read_rows, variables_of
from burstcast.probability.committee_event import (
    committee_chances,
    member_observables,
    see_event,
)
from burstcast.probability.typical_event import typical_event
from burstcast_workflow.harness.job import Settings, job, read_json, write_netcdf
from burstcast_workflow.jobs.forecasters import read_forecaster
from burstcast_workflow.jobs.gather import origins
from burstcast_workflow.jobs.probabilities import forecast_points
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time


def _forecasts(
    forecasters: Sequence[str],
    forecasts: Sequence[str],
    settings: Settings,
    given: tuple[FloatArray, int, FloatArray | None],
) -> dict[str, FloatArray]:
    """Observables that the members of each forecaster's ensemble forecast, by forecaster.

    Forecasters have the settings that their ``forecasts`` were made with, and this job's unit of
    time.
    """
    paths = {one.name: one.path for one in origins(forecasters)}
    found: dict[str, FloatArray] = {}
    for one in origins(forecasts):
        exponent = settings.computed_exponent
        known = Settings(one.settings, one.identity, computed_exponent=exponent)
        forecaster = read_forecaster(paths[one.name], known)
        observable = system_of(known).observable
        found[one.name.identifier] = member_observables(forecaster, observable, *given)
    return found


@job
def event_of_committees(
    *,
    ensemble: str,
    evaluation_set: str,
    calibration: str,
    forecasters: list[str],
    forecasts: list[str],
    committee_event: str,
    settings: Settings,
) -> None:
    """Write what happened, what all members forecast, votes, probabilities, alarm thresholds."""
    steps, threshold = lyapunov_time(settings), settings["case.event_threshold"]
    points = forecast_points(settings, evaluation_set, forecasts)
    times = settings["classification.prediction_times_lt"]
    committees = [source for source in points.alarms if source.committee]
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
        washout, schedules = points.data["washout"][point], points.data.get("parameter")
        in_force = None if schedules is None else schedules[point, : len(washout) - 1 + reach]
        observed = system_of(settings).observable(washout.T)
        row = settings["case.training.series"] + int(points.data["series"][point])
        now = int(points.data["step"][point])
        series = read_rows(ensemble, "observable", row, row + 1)[0]
        true = series[now + 1 - len(washout) : now + 1 + reach]
        found = _forecasts(forecasters, forecasts, settings, (washout, reach, in_force))
        fans = [np.concatenate([found[name] for name in one.forecasters]) for one in committees]
        happened = [bool(points.happened(time, threshold)[point]) for time in times]
        chosen = read_json(calibration)
        chances = committee_chances(points, point, committees, chosen, times, threshold)
    event = see_event(true, observed, fans, times, happened, chances, steps)
    kinds = [committee.name.keys["forecaster"] for committee in committees]
    whose = {"committees": " ".join(kinds)}
    which = {"point": -1 if point is None else point}
    write_netcdf(committee_event, variables_of(event), {**settings.provenance, **whose, **which})
