"""Forecast the evaluation set; keep only the window summaries."""

from burstcast.files.netcdf import read_netcdf
from burstcast.forecast.forecast_files import forecast_variables
from burstcast.forecast.window_forecasts import window_forecasts
from burstcast.forecast.windows import window_boundaries
from burstcast_workflow.harness.job import Settings, job, write_netcdf
from burstcast_workflow.jobs.forecasters import read_forecaster, seen
from burstcast_workflow.jobs.forecasts import windows_of
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time


@job
def forecast_evaluation_set(
    *, forecaster: str, evaluation_set: str, forecast: str, settings: Settings
) -> None:
    """Write the first and largest observable of every window of every forecast."""
    system = system_of(settings)
    boundaries = window_boundaries(*windows_of(settings), lyapunov_time(settings))
    bound = settings["forecaster.divergence_bound"]
    who = read_forecaster(forecaster, settings, bound)
    points = read_netcdf(evaluation_set)
    given = seen(who, points["washout"], points["true_washout"])
    forecasts = window_forecasts(who, system.observable, given, boundaries, points.get("parameter"))
    variables = forecast_variables(forecasts, system.observable_name)
    write_netcdf(forecast, variables, settings.provenance)
