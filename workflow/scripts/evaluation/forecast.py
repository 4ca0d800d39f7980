"""Forecast the evaluation set; keep only the window summaries."""

from burstcast.files.netcdf import read_netcdf
from burstcast.forecast.forecast_files import forecast_variables
from burstcast.forecast.window_forecasts import window_forecasts
from burstcast_workflow.harness.job import Settings, job, write_netcdf
from burstcast_workflow.jobs.forecasters import read_forecaster, seen
from burstcast_workflow.jobs.forecasts import boundaries_of
from burstcast_workflow.jobs.systems import system_of


@job
def forecast_evaluation_set(
    *, forecaster: str, evaluation_set: str, forecast: str, settings: Settings
) -> None:
    """Write the first and largest observable of every window of every forecast."""
    system, boundaries = system_of(settings), boundaries_of(settings)
    bound = settings["forecaster.divergence_bound"]
    model = read_forecaster(forecaster, settings, bound)
    points = read_netcdf(evaluation_set)
    given = seen(model, points["washout"], points["true_washout"])
    found = window_forecasts(model, system.observable, given, boundaries, points.get("parameter"))
    variables = forecast_variables(found, system.observable_name)
    write_netcdf(forecast, variables, settings.provenance)
