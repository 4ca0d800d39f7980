"""Lay out the starting points of the evaluation set in test series whose actuator switches."""

from burstcast_workflow.harness.job import job
from burstcast_workflow.jobs.forecasts import EvaluationPoints
from burstcast_workflow.jobs.series import Switched


class SwitchedPoints(EvaluationPoints, Switched):
    """Starting points in test series whose actuator switches."""


@job
def switched_evaluation_set_of_case(
    *, ensemble: str, evaluation_set: str, settings: SwitchedPoints
) -> None:
    """Write points in series that go on from the ends of the test series, with their schedules."""
    rows = settings.test_rows(ensemble)
    states, observed, schedules = settings.switched_series(ensemble, rows, "test")
    observable = settings.space.observable(states.transpose(2, 0, 1))
    series = states, observed, observable
    settings.write_points(evaluation_set, series, settings.spacing, schedules)
