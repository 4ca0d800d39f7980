"""Lay out the starting points that probabilities are calibrated on: never in the test series."""

from burstcast_workflow.harness.job import JobSettings, at, job
from burstcast_workflow.jobs.forecasts import Points
from burstcast_workflow.jobs.series import Tested, kept_series


class CalibrationPoints(JobSettings):
    """Starting points in the training series, or in series that are neither training nor test."""

    points: Points
    tested: Tested
    calibration_series: int = at("probability.calibration_series")
    spacing_lt: float = at("probability.start_spacing_lt")


@job
def calibration_set_of_case(
    *, ensemble: str, calibration_set: str, settings: CalibrationPoints
) -> None:
    """Write the points."""
    kept, training = kept_series(ensemble), settings.tested.training
    test, more = settings.tested.series(kept), settings.calibration_series
    needs = {str(CalibrationPoints.calibration_series): more} if more else {}
    training.check_series(kept, test_series=test, **needs)
    first = training.series + test
    rows = range(first, first + more) if more else range(training.series)
    clock = settings.points.washout.clock
    spacing = clock.positive_steps(settings.spacing_lt, CalibrationPoints.spacing_lt)
    settings.points.write_set(calibration_set, ensemble, rows, spacing)
