"""Lay out the starting points that probabilities are calibrated on: never in the test series."""

from burstcast_workflow.harness.job import Settings, job
from burstcast_workflow.jobs.data import check_kept_series, kept_series, test_series
from burstcast_workflow.jobs.forecasts import write_point_set


@job
def calibration_set_of_case(*, ensemble: str, calibration_set: str, settings: Settings) -> None:
    """Write points in the training series, or in series that are neither training nor test."""
    kept, training = kept_series(ensemble), settings["case.training.series"]
    test, more = test_series(settings, kept), settings["probability.calibration_series"]
    needs = {"training.series": training, "test_series": test}
    check_kept_series(kept, {**needs, "probability.calibration_series": more} if more else needs)
    rows = range(training + test, training + test + more) if more else range(training)
    spacing = "probability.start_spacing_lt", settings["probability.start_spacing_lt"]
    write_point_set(calibration_set, settings, ensemble, rows, spacing)
