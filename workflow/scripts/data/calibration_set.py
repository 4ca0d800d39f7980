"""Lay out the starting points that probabilities are calibrated on: never in the test series."""

from burstcast_workflow.harness.job import at, job
from burstcast_workflow.jobs.forecasts import Points
from burstcast_workflow.jobs.series import Tested, kept_series


class CalibrationPoints(Points, Tested):
    """Starting points in the training series, or in series that are neither training nor test."""

    calibration_series: int = at("probability.calibration_series")
    spacing_lt: float = at("probability.start_spacing_lt")


@job
def calibration_set_of_case(
    *, ensemble: str, calibration_set: str, settings: CalibrationPoints
) -> None:
    """Write the points."""
    kept, training = kept_series(ensemble), settings.training_series
    test, more = settings.test_series(kept), settings.calibration_series
    needs = {str(CalibrationPoints.calibration_series): more} if more else {}
    settings.check_series(kept, test_series=test, **needs)
    rows = range(training + test, training + test + more) if more else range(training)
    spacing = settings.positive_steps(CalibrationPoints.spacing_lt)
    settings.write_point_set(calibration_set, ensemble, rows, spacing)
