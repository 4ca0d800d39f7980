"""Lay out the starting points in the training series that classifiers of events learn from."""

from burstcast_workflow.harness.job import JobSettings, at, job
from burstcast_workflow.jobs.forecasts import Points
from burstcast_workflow.jobs.series import kept_series


class TrainingPoints(JobSettings):
    """Starting points in the training series."""

    points: Points
    spacing_lt: float = at("forecasters.classifiers.start_spacing_lt")


@job
def training_set_of_case(*, ensemble: str, training_set: str, settings: TrainingPoints) -> None:
    """Write the points."""
    points, training = settings.points, settings.points.observed.training
    training.check_series(kept_series(ensemble))
    clock = points.washout.clock
    spacing = clock.positive_steps(settings.spacing_lt, TrainingPoints.spacing_lt)
    points.write_set(training_set, ensemble, range(training.series), spacing)
