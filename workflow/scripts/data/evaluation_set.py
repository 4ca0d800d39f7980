"""Lay out the starting points of the evaluation set: their washouts, and what truly follows."""

from burstcast_workflow.harness.job import Settings, job
from burstcast_workflow.jobs.forecasts import test_rows, write_point_set


@job
def evaluation_set_of_case(*, ensemble: str, evaluation_set: str, settings: Settings) -> None:
    """Write points in the test series."""
    spacing = "classification.start_spacing_lt", settings["classification.start_spacing_lt"]
    write_point_set(evaluation_set, settings, ensemble, test_rows(settings, ensemble), spacing)
