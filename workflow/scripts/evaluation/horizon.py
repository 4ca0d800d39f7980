"""Measure how long before each extreme event a forecaster predicts it."""

from burstcast import durations
from burstcast.files.netcdf import read_netcdf
from burstcast.forecast.forecast_files import horizon_variables
from burstcast.forecast.horizon import HorizonSearch, prediction_horizons
from burstcast_workflow.harness.job import Provenance, job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_json, write_netcdf
from burstcast_workflow.jobs.forecasters import read_forecaster, seen
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time


@job
def measure_horizons(
    *,
    forecaster: str,
    events: str,
    summary: str,
    time_unit: str | list[str],
    horizon: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write the prediction horizon of every event."""
    data, steps = read_netcdf(events), lyapunov_time(settings, time_unit)
    distance = settings["case.event_threshold"] - read_json(summary)["mean_observable"]
    who = read_forecaster(forecaster, settings, time_unit)
    horizons = prediction_horizons(
        who,
        system_of(settings).observable,
        seen(who, data["observed"], data["true_state"]),
        data["truth"],
        HorizonSearch(
            longest_lead_time_lt=settings["horizon.longest_lead_time_lt"],
            lead_time_step_lt=settings["horizon.lead_time_step_lt"],
            tolerance=settings["horizon.tolerance"] * distance,
            washout=durations.steps(settings["washout_lt"], steps),
            steps_per_lyapunov_time=steps,
        ),
    )
    write_netcdf(horizon, horizon_variables(data["series"], data["step"], horizons), provenance)
