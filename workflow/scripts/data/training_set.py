"""Lay out the starting points in the training series that classifiers of events learn from."""

from burstcast_workflow.harness.job import Settings, job
from burstcast_workflow.jobs.data import check_kept_series, kept_series
from burstcast_workflow.jobs.forecasts import write_point_set


@job
def training_set_of_case(*, ensemble: str, training_set: str, settings: Settings) -> None:
    """Write points in the training series."""
    training = settings["case.training.series"]
    check_kept_series(kept_series(ensemble), {"training.series": training})
    spacing_lt = settings["forecasters.classifiers.start_spacing_lt"]
    spacing = "forecasters.classifiers.start_spacing_lt", spacing_lt
    write_point_set(training_set, settings, ensemble, range(training), spacing)
