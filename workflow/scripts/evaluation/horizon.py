"""Measure how long before each extreme event a forecaster predicts it."""

from burstcast.files.netcdf import read_netcdf
from burstcast.forecast.forecast_files import horizon_variables
from burstcast.forecast.horizon import prediction_horizons
from burstcast_workflow.harness.job import Settings, job, write_netcdf
from burstcast_workflow.jobs.forecasters import read_forecaster, seen
from burstcast_workflow.jobs.forecasts import horizon_search
from burstcast_workflow.jobs.systems import system_of


@job
def measure_horizons(
    *, forecaster: str, events: str, summary: str, horizon: str, settings: Settings
) -> None:
    """Write the prediction horizon of every event."""
    data, model = read_netcdf(events), read_forecaster(forecaster, settings)
    horizons = prediction_horizons(
        model,
        system_of(settings).observable,
        seen(model, data["observed"], data["true_state"]),
        data["truth"],
        horizon_search(settings, summary),
        data.get("parameter"),
    )
    write_netcdf(
        horizon, horizon_variables(data["series"], data["step"], horizons), settings.provenance
    )
