"""Calibrate the probabilities of all sources of alarms in a case, and choose their thresholds."""

from typing import Any

from burstcast.probability.alarm_rule import CALIBRATED, VOTES, AlarmRule
from burstcast.probability.calibration import UNCALIBRATED, isotonic, logistic
from burstcast_workflow.harness.job import Settings, job, write_json
from burstcast_workflow.jobs.probabilities import forecast_points
from burstcast_workflow.jobs.time_unit import lyapunov_time


@job
def calibrate(
    *, calibration_set: str, calibration_forecasts: list[str], calibration: str, settings: Settings
) -> None:
    """Write calibrations and thresholds by alarm, event threshold and prediction time."""
    points = forecast_points(settings, calibration_set, calibration_forecasts)
    alarms: dict[str, Any] = {}
    for alarm in points.alarms:
        # the sweep of the event threshold is for compared forecasters
        factors = settings["probability.threshold_factors"] if alarm.compared else []
        for factor in sorted({1.0, *factors}):
            event_threshold = factor * settings["case.event_threshold"]
            if not points.knows(alarm, event_threshold):
                continue
            by_factor = alarms.setdefault(alarm.identifier, {}).setdefault(f"{factor:g}", {})
            for time in settings["classification.prediction_times_lt"]:
                outcomes = points.outcomes(alarm, time, event_threshold).total()
                if alarm.forecasters:
                    prior = settings["probability.prior_forecasts"]
                    shares = points.classifier(alarm) is None
                    calibrated = isotonic(outcomes, prior) if shares else logistic(outcomes)
                    maps = {CALIBRATED: calibrated, VOTES: UNCALIBRATED}
                else:  # what a baseline is raised by is no probability
                    maps = {CALIBRATED: isotonic(outcomes)}
                by_factor[f"{time:g}"] = rules = {}
                for name, found in maps.items():
                    rules[name] = AlarmRule.chosen(outcomes, found).record()
    for identifier, threshold in settings["uncalibrated"].items():
        # there are no forecasts of the calibration set: probabilities are taken as they are
        rule = AlarmRule(UNCALIBRATED, threshold).record()
        alarms[identifier] = {
            f"{factor:g}": {
                f"{time:g}": {CALIBRATED: rule, VOTES: rule}
                for time in settings["classification.prediction_times_lt"]
            }
            for factor in sorted({1.0, *settings["probability.threshold_factors"]})
        }
    record = {"steps_per_lyapunov_time": lyapunov_time(settings), "alarms": alarms}
    write_json(calibration, record, settings.provenance)
