"""Forecasts that probabilities come from, as a job has them."""

from collections.abc import Sequence

from burstcast.base.files.netcdf import read_netcdf
from burstcast.forecasts.forecast_files import forecasts_from
from burstcast.forecasts.forecast_points import ForecastPoints
from burstcast_workflow.harness.settings import JobSettings, at
from burstcast_workflow.jobs.gather import origins


class Alarms(JobSettings):
    """Events that are forecast with a probability."""

    event_threshold: float = at("case.event_threshold")
    prediction_times_lt: list[float] = at("classification.prediction_times_lt")
    window_lt: float = at("classification.window_lt")
    resolution_lt: float = at("classification.resolution_lt")

    def forecast_points(self, point_set: str, forecasts: Sequence[str] = ()) -> ForecastPoints:
        """Read the starting points of a case, and the forecasts from them."""
        return ForecastPoints(
            read_netcdf(point_set),
            {
                origin.name.identifier: forecasts_from(read_netcdf(origin.path))
                for origin in origins(forecasts)
            },
            self.window_lt,
            self.resolution_lt,
        )
