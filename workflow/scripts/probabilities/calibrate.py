"""Calibrate the probabilities of all sources of alarms in a case, and choose their thresholds."""

from burstcast.probability.calibrated_alarms import calibrated_alarms, uncalibrated_alarms
from burstcast_workflow.harness.job import Settings, job, write_json
from burstcast_workflow.jobs.probabilities import forecast_points
from burstcast_workflow.jobs.time_unit import lyapunov_time


@job
def calibrate(
    *, calibration_set: str, calibration_forecasts: list[str], calibration: str, settings: Settings
) -> None:
    """Write calibrations and thresholds by alarm and prediction time."""
    times = settings["classification.prediction_times_lt"]
    alarms = calibrated_alarms(
        forecast_points(settings, calibration_set, calibration_forecasts),
        times,
        settings["case.event_threshold"],
        settings["probability.prior_forecasts"],
    )
    # of these, there are no forecasts of the calibration set
    alarms |= uncalibrated_alarms(settings["uncalibrated"], times)
    record = {"steps_per_lyapunov_time": lyapunov_time(settings), "alarms": alarms}
    write_json(calibration, record, settings.provenance)
