"""Series with schedules of the parameters in force, which some kinds of forecasters learn from."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.data.scheduled_series import ScheduledSeries, joined
from burstcast.files.netcdf import Variable, read_attributes, read_netcdf
from burstcast.files.units import COMPONENT
from burstcast_workflow.harness.storage import write_netcdf
from burstcast_workflow.jobs.gather import origins


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
    """Write series, their observations, and the schedule of each."""
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
