"""Lay out the starting points of the evaluation set in test series whose actuator switches."""

from burstcast_workflow.harness.job import JobSettings, job
from burstcast_workflow.jobs.forecasts import EvaluationPoints
from burstcast_workflow.jobs.series import Switched


class SwitchedPoints(JobSettings):
    """Starting points in test series whose actuator switches."""

    evaluation: EvaluationPoints
    switched: Switched


@job
def switched_evaluation_set_of_case(
    *, ensemble: str, evaluation_set: str, settings: SwitchedPoints
) -> None:
    """Write points in series that go on from the ends of the test series, with their schedules."""
    evaluation, points = settings.evaluation, settings.evaluation.points
    rows = evaluation.tested.rows(ensemble)
    states, observed, schedules = settings.switched.series(ensemble, rows, "test")
    observable = points.system.space.observable(states.transpose(2, 0, 1))
    series = states, observed, observable
    points.write(evaluation_set, series, evaluation.spacing, schedules)
