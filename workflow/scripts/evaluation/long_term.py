"""Let a forecaster run freely from many points of the training set; keep its statistics."""

from burstcast.statistics.long_term import run_long_term
from burstcast_workflow.harness.job import JobSettings, job, write_netcdf
from burstcast_workflow.jobs.forecasters import Forecasting
from burstcast_workflow.jobs.forecasts import LongTerm


class FreeRuns(JobSettings):
    """Long runs of a forecaster."""

    forecasting: Forecasting
    long_term: LongTerm


@job
def run_freely(*, ensemble: str, forecaster: str, long_term: str, settings: FreeRuns) -> None:
    """Write the forecaster's long-term statistics and what became of each closed loop."""
    forecasting, runs = settings.forecasting, settings.long_term.runs
    model = forecasting.read_forecaster(forecaster)
    run = run_long_term(
        model,
        forecasting.system.space.observable,
        runs.washouts(ensemble, model),
        settings.long_term.settings(ensemble),
    )
    write_netcdf(long_term, run.variables(), settings.provenance)
