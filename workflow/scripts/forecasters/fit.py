"""Fit a forecaster of a kind that needs no search."""

from burstcast_workflow.harness.job import job
from burstcast_workflow.jobs.forecasters import Observing, kind_of, write_forecaster
from burstcast_workflow.jobs.scheduled import read_scheduled


@job
def fit(*, ensemble: str, scheduled: list[str], forecaster: str, settings: Observing) -> None:
    """Write what it has learnt."""
    kind, case = kind_of(settings.forecaster), settings.forecasting_case(ensemble)
    if scheduled:
        learnt = read_scheduled(scheduled, settings.case)
        fitted = kind.fit(learnt.observed.states, case, learnt.schedules)
    else:
        fitted = kind.fit(settings.learnt_rows(kind, ensemble), case)
    write_forecaster(forecaster, fitted, settings.provenance)
