"""Read forecasts that another program has made, as the tables take them."""

from pathlib import Path

import numpy as np

from burstcast.benchmark.forecast_files import check_version, facts_of, read_forecasts
from burstcast.files.netcdf import read_netcdf
from burstcast.forecast.event_probabilities import EventProbabilities
from burstcast.forecast.forecast_files import forecast_variables, horizon_variables
from burstcast.forecast.horizon import prediction_horizons
from burstcast.forecasters._recorded import RecordedForecasts
from burstcast.forecasters.external import ExternalForecasts
from burstcast_workflow.harness.job import Provenance, job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import write_netcdf
from burstcast_workflow.jobs.forecast_task import task_data


@job
def read_external_forecasts(
    *,
    files: list[str],
    ensemble: str,
    evaluation_set: str,
    events: str,
    summary: str,
    time_unit: str | list[str],
    forecast: str,
    horizon: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write window summaries or probabilities, and prediction horizons: NaN where none is given."""
    data = task_data(settings, ensemble, evaluation_set, events, summary, time_unit)
    paths = [Path(file) for file in files]
    for path in paths:
        check_version(path, facts_of(path), data.task.version)
    given = read_forecasts(paths, data.task)
    resolution = settings["classification.resolution_lt"]
    spans = [
        (round(time / resolution) - 1, round(data.window_lt / resolution))
        for time in data.task.prediction_times_lt
    ]
    times, threshold = data.task.prediction_times_lt, data.event_threshold
    found = ExternalForecasts.of(given, times, spans, threshold).forecasts
    if isinstance(found, EventProbabilities):
        variables = found.variables()
    else:
        variables = forecast_variables(found, data.task.space.observable_name)
    write_netcdf(forecast, variables, provenance)
    before = read_netcdf(events)
    horizons = np.full(len(before["step"]), np.nan)
    if given.horizon is not None:
        recorded = RecordedForecasts(data.horizon_washouts, given.horizon[..., np.newaxis])
        horizons = prediction_horizons(
            recorded, lambda outputs: outputs[0], before["observed"], before["truth"], data.search
        )
    write_netcdf(horizon, horizon_variables(before["series"], before["step"], horizons), provenance)
