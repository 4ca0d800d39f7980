"""Let a forecaster run freely from many points of the training set; keep its statistics."""

from burstcast.statistics.long_term import run_long_term
from burstcast_workflow.harness.job import job, write_netcdf
from burstcast_workflow.jobs.forecasters import Forecasting
from burstcast_workflow.jobs.forecasts import LongTerm


class FreeRuns(Forecasting, LongTerm):
    """Long runs of a forecaster."""


@job
def run_freely(*, ensemble: str, forecaster: str, long_term: str, settings: FreeRuns) -> None:
    """Write the forecaster's long-term statistics and what became of each closed loop."""
    model = settings.read_forecaster(forecaster)
    how, washouts = settings.long_term(ensemble), settings.washouts(ensemble, model)
    run = run_long_term(model, settings.space.observable, washouts, how)
    write_netcdf(long_term, run.variables(), settings.provenance)
