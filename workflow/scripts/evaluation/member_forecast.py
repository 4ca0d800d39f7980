"""Forecast the evaluation set with every member of an ensemble; keep only window summaries."""

from burstcast.forecast.windows import window_boundaries
from burstcast.netcdf import read_netcdf
from burstcast.probability.members import member_summaries
from burstcast_workflow.harness.job import Provenance, run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.forecasters import read_forecaster
from burstcast_workflow.jobs.members import with_members, write_member_forecasts
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time
from burstcast_workflow.jobs.windows import windows_of


def forecast_with_members(
    *,
    forecaster: str,
    evaluation_set: str,
    time_unit: str | list[str],
    member_forecast: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write the first and largest observable of every window of every member's forecast."""
    system = system_of(settings)
    boundaries = window_boundaries(*windows_of(settings), lyapunov_time(settings, time_unit))
    who = with_members(read_forecaster(forecaster, settings, time_unit))
    washouts = read_netcdf(evaluation_set, "washout")["washout"]
    members = member_summaries(who, system.observable, washouts, boundaries)
    write_member_forecasts(member_forecast, members, system.observable_name, provenance)


if __name__ == "__main__":
    run_job(snakemake, forecast_with_members)  # noqa: F821 - Snakemake puts it there
