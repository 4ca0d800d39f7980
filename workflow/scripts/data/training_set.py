"""Lay out the starting points in the training series that classifiers of events learn from."""

from burstcast_workflow.harness.job import at, job
from burstcast_workflow.jobs.forecasts import Points
from burstcast_workflow.jobs.series import kept_series


class TrainingPoints(Points):
    """Starting points in the training series."""

    spacing_lt: float = at("forecasters.classifiers.start_spacing_lt")


@job
def training_set_of_case(*, ensemble: str, training_set: str, settings: TrainingPoints) -> None:
    """Write the points."""
    settings.check_series(kept_series(ensemble))
    rows, spacing = range(settings.training_series), TrainingPoints.spacing_lt
    settings.write_point_set(training_set, ensemble, rows, settings.positive_steps(spacing))
