"""Read forecasts that another program has made, as the tables take them."""

from pathlib import Path

import numpy as np

from burstcast.benchmark.forecast_files import read_forecasts
from burstcast.files.netcdf import read_netcdf
from burstcast.forecast.forecast_files import horizon_variables
from burstcast.forecasters._recorded import recorded_horizons
from burstcast.forecasters.external import ExternalForecasts
from burstcast_workflow.harness.job import job, write_netcdf
from burstcast_workflow.jobs.forecast_task import Task


@job
def read_external_forecasts(
    *,
    files: list[str],
    ensemble: str,
    evaluation_set: str,
    events: str,
    summary: str,
    forecast: str,
    horizon: str,
    settings: Task,
) -> None:
    """Write window summaries or probabilities, and prediction horizons: NaN where none is given."""
    data = settings.data(ensemble, evaluation_set, events, summary)
    given = read_forecasts([Path(file) for file in files], data.task)
    found = ExternalForecasts.of(given, data.task, data.event_threshold)
    write_netcdf(forecast, found.variables(data.task.space.observable_name), settings.provenance)
    before = read_netcdf(events)
    horizons = np.full(len(before["step"]), np.nan)
    if given.horizon is not None:
        horizons = recorded_horizons(
            data.horizon_washouts, given.horizon, before["observed"], before["truth"], data.search
        )
    variables = horizon_variables(before["series"], before["step"], horizons)
    write_netcdf(horizon, variables, settings.provenance)
