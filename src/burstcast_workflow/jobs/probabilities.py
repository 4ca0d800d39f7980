"""Forecasts that probabilities come from, as a job has them."""

from collections.abc import Sequence

from burstcast.files.netcdf import read_netcdf
from burstcast.forecast.forecast_files import forecasts_from
from burstcast.probability.forecast_points import ForecastPoints
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.gather import origins


def forecast_points(settings: Settings, point_set: str, forecasts: Sequence[str]) -> ForecastPoints:
    """Read the starting points of a case, and the forecasts from them: inputs of the job."""
    return ForecastPoints(
        read_netcdf(point_set),
        {one.name.identifier: forecasts_from(read_netcdf(one.path)) for one in origins(forecasts)},
        settings["classification.window_lt"],
        settings["classification.resolution_lt"],
    )
