"""Lay out the starting points of the evaluation set: their washouts, and what truly follows."""

from burstcast_workflow.harness.job import job
from burstcast_workflow.jobs.forecasts import EvaluationPoints


@job
def evaluation_set_of_case(
    *, ensemble: str, evaluation_set: str, settings: EvaluationPoints
) -> None:
    """Write points in the test series."""
    rows = settings.tested.rows(ensemble)
    settings.points.write_set(evaluation_set, ensemble, rows, settings.spacing)
