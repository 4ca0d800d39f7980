"""Let a forecaster run freely from many points of the training set; keep its statistics."""

from burstcast.statistics.long_term import run_long_term
from burstcast_workflow.harness.job import Settings, job, write_netcdf
from burstcast_workflow.jobs.forecasters import read_forecaster
from burstcast_workflow.jobs.long_runs import long_run_washouts, long_term_settings
from burstcast_workflow.jobs.systems import system_of


@job
def run_freely(*, ensemble: str, forecaster: str, long_term: str, settings: Settings) -> None:
    """Write the forecaster's long-term statistics and what became of each closed loop."""
    bound = settings["forecaster.divergence_bound"]
    model = read_forecaster(forecaster, settings, bound)
    how = long_term_settings(settings, ensemble)
    washouts = long_run_washouts(settings, ensemble, model)
    run = run_long_term(model, system_of(settings).observable, washouts, how)
    write_netcdf(long_term, run.variables(), settings.provenance)
