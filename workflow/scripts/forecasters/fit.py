"""Fit a forecaster of a kind that needs no search."""

from burstcast.forecasters._limits import TrainingLimits
from burstcast.forecasters.registry import as_forecaster
from burstcast_workflow.harness.job import job, tell
from burstcast_workflow.jobs.forecasters import Observing, write_forecaster
from burstcast_workflow.jobs.series import read_scheduled


@job
def fit(*, ensemble: str, scheduled: list[str], forecaster: str, settings: Observing) -> None:
    """Write what it has learnt."""
    unfitted = as_forecaster(settings.forecasting.unfitted())
    case = settings.forecasting.forecasting_case(ensemble)
    if scheduled:
        training = read_scheduled(scheduled, settings.case).observed
    else:
        training = settings.learnt_rows(unfitted, ensemble)
    limits = TrainingLimits.of(training, case.system.dimension)
    fitted = unfitted.fit(training, case)
    for text in fitted.weaknesses():
        tell(text)
    write_forecaster(forecaster, fitted, settings.provenance, limits)
