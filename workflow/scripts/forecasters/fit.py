"""Fit a forecaster of a kind that needs no search."""

from burstcast.forecasters._names import parsed
from burstcast.forecasters.registry import forecaster_class
from burstcast_workflow.harness.job import Settings, job
from burstcast_workflow.jobs.forecasters import forecasting_case, learnt_rows, write_forecaster
from burstcast_workflow.jobs.scheduled import read_scheduled


@job
def fit(*, ensemble: str, scheduled: list[str], forecaster: str, settings: Settings) -> None:
    """Write what it has learnt."""
    kind = forecaster_class(parsed(settings["forecaster"]).kind)
    case = forecasting_case(settings, ensemble)
    if scheduled:
        learnt = read_scheduled(scheduled, settings["case"])
        fitted = kind.fit(learnt.observed.states, case, learnt.schedules)
    else:
        fitted = kind.fit(learnt_rows(kind, settings, ensemble), case)
    write_forecaster(forecaster, fitted, settings.provenance)
