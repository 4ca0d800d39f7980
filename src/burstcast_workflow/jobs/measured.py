"""Measured series of a job's case, from the files that they come in."""

from collections.abc import Mapping, Sequence
from typing import Any

from burstcast.arrays import FloatArray
from burstcast.measured_data import (
    Quantity,
    Run,
    blocks_of,
    check_equidistant,
    series_of_runs,
)
from burstcast.systems.measured import MeasuredSeries
from burstcast_workflow.harness.storage import read_netcdf
from burstcast_workflow.jobs.series_files import read_runs
from burstcast_workflow.jobs.time_unit import sampling_interval

Settings = Mapping[str, Any]


def measured_series(settings: Settings, sources: Sequence[str]) -> FloatArray:
    """Series of states, ``(series, time, component)``, checked.

    Parameters
    ----------
    settings
        With ``case.data``, ``case.parameters`` and the time step.
    sources
        The files, in the order of their series.

    Raises
    ------
    ValueError
        If anything is wrong with them.
    """
    data, time_step = settings["case.data"], sampling_interval(settings)
    space = MeasuredSeries(**settings["case.parameters"])
    quantities = [Quantity(text) for text in data["components"]]
    blocks = data["blocks"]
    cut = blocks and blocks_of(blocks["duration"], blocks["gap"], time_step)
    if data["case"] is not None:
        runs = _runs_of_case(sources[0], data["columns"])
        return series_of_runs(runs, space, quantities, cut)
    time = data["time"]
    taken = [*quantities, *([Quantity(space.observable_of)] if space.appended else [])]

    def needed(known: Sequence[str]) -> list[str]:
        asked = [*taken, *([Quantity(time)] if time else [])]
        return list(dict.fromkeys(name for one in asked for name in one.columns(known)))

    runs = [run for path in sources for run in read_runs(path, data, needed)]
    if time is not None:
        for run in runs:
            check_equidistant(run.name, time, run.columns[time], time_step)
    return series_of_runs(runs, space, quantities, cut)


def _runs_of_case(ensemble: str, components: Sequence[str]) -> list[Run]:
    """Series of another case: its components and its observable."""
    found = read_netcdf(ensemble, "state", "observable")
    return [
        Run(
            f"{ensemble}, series {number}",
            {**dict(zip(components, states.T, strict=True)), "observable": observable},
        )
        for number, (states, observable) in enumerate(
            zip(found["state"], found["observable"], strict=True), 1
        )
    ]
