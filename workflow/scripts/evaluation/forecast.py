"""Forecast the evaluation set; keep only the window summaries."""

from typing import Any

from burstcast.base.files.netcdf import read_netcdf
from burstcast.forecasts.forecast_files import forecast_variables
from burstcast.forecasts.windows import window_forecasts
from burstcast_workflow.harness.job import JobSettings, at, job, write_netcdf
from burstcast_workflow.jobs.forecasters import Forecasting, seen
from burstcast_workflow.jobs.forecasts import Windows


class Forecasts(JobSettings):
    """Forecasts of windows; some forecasters know the parameters in force."""

    forecasting: Forecasting
    windows: Windows
    aware: dict[str, Any] | None = at("forecasters.aware", otherwise=None)


@job
def forecast_evaluation_set(
    *, forecaster: str, evaluation_set: str, forecast: str, settings: Forecasts
) -> None:
    """Write the first and largest observable of every window of every forecast."""
    space, boundaries = settings.forecasting.system.space, settings.windows.boundaries
    model = settings.forecasting.read_forecaster(forecaster, settings.aware)
    points = read_netcdf(evaluation_set)
    washouts = seen(model, points["washout"], points["true_washout"], points.get("parameter"))
    forecasts = window_forecasts(model, space.observable, washouts, boundaries)
    variables = forecast_variables(forecasts, space.observable_name)
    write_netcdf(forecast, variables, settings.provenance)
