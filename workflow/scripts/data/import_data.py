"""Check measured series, and copy them into an ensemble as simulated ones are in."""

import numpy as np

from burstcast.data.ensemble_files import START, ensemble_variables, schedule_variable
from burstcast.data.measured_data import kept_series
from burstcast.files.netcdf import Variable
from burstcast.files.units import TIME
from burstcast_workflow.harness.job import Settings, job, tell, write_json, write_netcdf
from burstcast_workflow.jobs.data import test_series
from burstcast_workflow.jobs.measured import measured_series, present_space, with_past
from burstcast_workflow.jobs.time_unit import sampling_interval


@job
def import_data(*, sources: list[str], ensemble: str, summary: str, settings: Settings) -> None:
    """Write the series, their observable, and a summary."""
    measured = measured_series(settings, sources)
    if measured.left_out:
        tell(measured.left_out)
    states = measured.states
    training, test = settings["case.training.series"], test_series(settings, len(states))
    if training + test > len(states):
        raise ValueError(
            f"training.series is {training} and test_series {test}, but the data have "
            f"{len(states)} series in all, of {states.shape[1]} samples each: ask for fewer, or "
            f"cut shorter blocks (data.blocks)"
        )
    space = present_space(settings)
    observable = np.stack([space.observable(series.T) for series in states])
    index, lifetimes = kept_series(observable, settings["case.laminarisation_threshold"])
    past = max(settings["case.data"]["delays"], default=0)
    variables, of_all = ensemble_variables(
        with_past(settings, states[index]),
        observable[index, past:],
        space.observable_name,
        index,
        np.maximum(lifetimes - past, 0),
        sampling_interval(settings),
    )
    if measured.known is not None:
        variables |= schedule_variable(measured.known[index, past + 1 :])
    if measured.start is not None:
        start = measured.start[index] + past * sampling_interval(settings)
        variables[START] = Variable(("series",), start, TIME, "time of the first sample")
    write_netcdf(ensemble, variables, settings.provenance)
    write_json(summary, of_all, settings.provenance)
