"""Check measured series, and copy them into an ensemble as simulated ones are in."""

import numpy as np

from burstcast.base.files.netcdf import Variable
from burstcast.base.files.units import TIME
from burstcast.base.series_lengths import held_after_the_end
from burstcast.data.ensemble_files import START, ensemble_variables, schedule_variable
from burstcast.data.measured_data import kept_series
from burstcast_workflow.harness.job import JobSettings, at, job, tell, write_json, write_netcdf
from burstcast_workflow.jobs.cases import Sampling
from burstcast_workflow.jobs.measured import MeasuredData


class Imported(JobSettings):
    """Measured series, and the thresholds of what is kept of them."""

    data: MeasuredData
    sampling: Sampling
    laminarisation_threshold: float | None = at("case.laminarisation_threshold")
    #: names and digests of the files, whose dates may be those of older ones
    contents: list[list[str]] = at("job.contents_of_data")


@job
def import_data(*, sources: list[str], ensemble: str, summary: str, settings: Imported) -> None:
    """Write the series, their observable, and a summary."""
    data, interval = settings.data, settings.sampling.interval
    measured = data.measured_series(sources)
    for message in measured.drift + measured.messages:
        tell(message)
    states = measured.states
    space = data.present_space
    observable = np.stack([space.observable(series.T) for series in states])
    observable[np.isnan(states[..., 0])] = np.nan
    index, lifetimes = kept_series(observable, settings.laminarisation_threshold)
    variables, of_all = ensemble_variables(
        data.with_past(states[index]),
        observable[index, data.past :],
        space.observable_name,
        index,
        np.maximum(lifetimes - data.past, 0),
        interval,
    )
    if measured.covariates is not None:
        covariates = held_after_the_end(measured.covariates)
        variables |= schedule_variable(covariates[index, data.past + 1 :])
    if measured.start is not None:
        start = measured.start[index] + data.past * interval
        variables[START] = Variable(("series",), start, TIME, "time of the first sample")
    write_netcdf(ensemble, variables, settings.provenance)
    write_json(summary, {**of_all, "files": settings.contents}, settings.provenance)
