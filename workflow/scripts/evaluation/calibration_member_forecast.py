"""Forecast the calibration set out of sample with every member of an ensemble."""

from burstcast import durations
from burstcast.forecast.windows import window_boundaries
from burstcast.netcdf import read_netcdf
from burstcast.probability.members import leave_one_out_member_summaries, member_summaries
from burstcast_workflow.harness.job import Provenance, run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.data import observed_rows, training_states
from burstcast_workflow.jobs.forecasters import forecasting_case, read_forecaster
from burstcast_workflow.jobs.members import with_members, write_member_forecasts
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time
from burstcast_workflow.jobs.windows import windows_of


def forecast_calibration_set_with_members(
    *,
    ensemble: str,
    forecaster: str,
    calibration_set: str,
    time_unit: str | list[str],
    calibration_member_forecast: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Forecast each training series without what it has taught, or other series as they are."""
    system, steps = system_of(settings), lyapunov_time(settings, time_unit)
    boundaries = window_boundaries(*windows_of(settings), steps)
    who = with_members(read_forecaster(forecaster, settings, time_unit))
    points = read_netcdf(calibration_set, "series", "washout")
    if settings["probability.calibration_series"]:
        members = member_summaries(who, system.observable, points["washout"], boundaries)
    else:
        members = leave_one_out_member_summaries(
            who,
            observed_rows(settings, ensemble, 0, training_states(settings, ensemble)),
            forecasting_case(settings, time_unit),
            durations.steps(settings["washout_lt"], steps),
            system.observable,
            points["washout"],
            points["series"],
            boundaries,
        )
    write_member_forecasts(calibration_member_forecast, members, system.observable_name, provenance)


if __name__ == "__main__":
    run_job(snakemake, forecast_calibration_set_with_members)  # noqa: F821 - Snakemake puts it there
