"""Measure how long before each extreme event a forecaster predicts it."""

from burstcast.base.files.netcdf import read_netcdf
from burstcast.forecasts.forecast_files import horizon_variables
from burstcast.forecasts.horizon import prediction_horizons
from burstcast_workflow.harness.job import JobSettings, job, write_netcdf
from burstcast_workflow.jobs.forecasters import Forecasting, seen
from burstcast_workflow.jobs.forecasts import Horizons


class HorizonsOfForecaster(JobSettings):
    """How the horizons of a forecaster are measured."""

    forecasting: Forecasting
    horizons: Horizons


@job
def measure_horizons(
    *, forecaster: str, events: str, summary: str, horizon: str, settings: HorizonsOfForecaster
) -> None:
    """Write the prediction horizon of every event."""
    data, model = read_netcdf(events), settings.forecasting.read_forecaster(forecaster)
    observed = seen(model, data["observed"], data["true_state"], data.get("parameter"))
    horizons = prediction_horizons(
        model,
        settings.forecasting.system.space.observable,
        observed,
        data["truth"],
        settings.horizons.search(summary),
        inputs=observed.shape[2] - data["observed"].shape[2],
    )
    write_netcdf(
        horizon, horizon_variables(data["series"], data["step"], horizons), settings.provenance
    )
