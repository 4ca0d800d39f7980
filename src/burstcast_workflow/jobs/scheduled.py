"""Series with schedules of the parameters in force, which some kinds of forecasters learn from."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from burstcast import durations, random_streams
from burstcast.arrays import FloatArray
from burstcast.control.actuation import ActuationValues, actuated_system
from burstcast.data.dataset import component_scales, observed_series
from burstcast.data.scheduled_series import (
    RandomActuation,
    ScheduledSeries,
    joined,
    simulated_series,
)
from burstcast.files.netcdf import Variable, read_attributes, read_netcdf, read_rows
from burstcast.files.units import COMPONENT
from burstcast.systems.parameters import SHARE, SystemParameters
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import write_netcdf
from burstcast_workflow.jobs.gather import origins
from burstcast_workflow.jobs.systems import equations_of, parameters_of

CANDIDATES = 8
"""Switched series that are drawn for each one that is wanted, for some may laminarise."""


@dataclass(frozen=True)
class TrainingSet:
    """Series of several cases that a forecaster learns from, the cases in turn.

    Attributes
    ----------
    true, observed
        The series as they truly are, and as they are observed.
    own_rows
        Rows of a case's own training series among them, in their order; none where the case gives
        other series, or none.
    """

    true: ScheduledSeries
    observed: ScheduledSeries
    own_rows: list[int]

    @property
    def schedules(self) -> FloatArray:
        """Values in force from each sample to the next, ``(series, time - 1, parameters)``."""
        return self.observed.schedules


def write_scheduled(
    path: str,
    true: ScheduledSeries,
    observed: FloatArray,
    actuated: bool,
    provenance: Mapping[str, str],
) -> None:
    """Write series, what is observed of them, and the schedule of each."""
    states, steps = ("series", "time", "component"), ("series", "step", "parameter")
    schedule = "value of each parameter in force from each sample to the next"
    write_netcdf(
        path,
        {
            "state": Variable(states, true.states, COMPONENT, "state of the system"),
            "observed": Variable(states, observed, COMPONENT, "observed state"),
            "parameter": Variable(steps, true.schedules, None, schedule),
        },
        {**provenance, "actuated": int(actuated)},
    )


def read_scheduled(paths: Sequence[str], case: str) -> TrainingSet:
    """Read series that `write_scheduled` wrote, of several cases, for a forecaster of one.

    Series of different cases take turns, so that the first ones, on which networks are validated,
    are of all of them.
    """
    parts, rows = [read_netcdf(path, "state", "observed", "parameter") for path in paths], []
    true, observed = (
        joined([ScheduledSeries(part[name], part["parameter"]) for part in parts])
        for name in ("state", "observed")
    )
    counts = [len(part["state"]) for part in parts]
    number = np.concatenate([np.arange(count) for count in counts])
    turn = np.argsort(number, kind="stable")
    for origin, first, count in zip(origins(paths), np.cumsum([0, *counts]), counts, strict=False):
        if origin.identity["case"] == case and not int(read_attributes(origin.path)["actuated"]):
            rows = [int(np.flatnonzero(turn == row)[0]) for row in range(first, first + count)]
    true, observed = (
        ScheduledSeries(one.states[turn], one.schedules[turn]) for one in (true, observed)
    )
    return TrainingSet(true, observed, rows)


def switched_series(
    settings: Settings, ensemble: str, rows: range, steps_per_lyapunov_time: int, purpose: str
) -> tuple[ScheduledSeries, FloatArray]:
    """Series under an actuator that switches at random, and what is observed of them.

    Parameters
    ----------
    settings
        With ``parameters``, the names of what forecasters are told.
    ensemble
        Path of the ensemble.
    rows
        Its series, from whose ends the flows go on.
    steps_per_lyapunov_time
        Steps of a forecast in a Lyapunov time.
    purpose
        "training" or "test": the random streams are called after it.
    """
    given, actuation = settings["case.training.actuation"], settings["case.actuation"]
    system, names = equations_of(settings), settings["parameters"]
    parameters = parameters_of(settings, names)
    on: tuple[float, ...] = (given["strength"],)
    if names != [SHARE]:
        actuated = actuated_system(
            system, actuation["parameters"], actuation["force"], given["strength"]
        )
        on = SystemParameters.of(actuated, names).own
    interval = durations.positive_steps(
        given["interval_lt"], steps_per_lyapunov_time, "training.actuation.interval_lt"
    )
    switching = RandomActuation(
        interval,
        given["mean_on_lt"] / given["interval_lt"],
        given["mean_off_lt"] / given["interval_lt"],
    )
    root, case = settings["random_seed"], settings["case"]
    free = read_rows(ensemble, "state", rows.start, rows.stop)
    acting = switching.draw(
        CANDIDATES * len(rows),
        free.shape[1] - 1,
        random_streams.stream(root, f"{purpose} actuation", case),
    )
    found, _ = simulated_series(
        parameters,
        system,
        np.ascontiguousarray(np.tile(free[:, -1].T, CANDIDATES)),
        ActuationValues(parameters.own, on).schedule(acting.T).transpose(2, 0, 1),
        len(rows),
        time_step=settings["case.ensemble.time_step"],
        sampling_stride=settings["case.ensemble.sampling_stride"],
        laminarisation_threshold=settings["case.laminarisation_threshold"],
    )
    training = read_rows(ensemble, "state", 0, settings["case.training.series"])
    observed = observed_series(
        found.states,
        rows.start,
        settings["case.training.noise"],
        component_scales(training),
        root,
        f"{case} actuated",
    )
    return found, observed
