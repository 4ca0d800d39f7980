"""Calibrations and alarm thresholds of all sources of alarms in a case."""

from collections.abc import Sequence
from typing import Any

from burstcast.forecasts.alarm_rule import CALIBRATED, VOTES, AlarmRule
from burstcast.forecasts.alarm_sources import AlarmSource
from burstcast.forecasts.calibration import UNCALIBRATED, isotonic, logistic
from burstcast.forecasts.forecast_points import ForecastPoints


def calibrated_alarms(
    points: ForecastPoints,
    prediction_times_lt: Sequence[float],
    event_threshold: float,
    prior: float,
) -> dict[str, Any]:
    """Records of `AlarmRule` by source of alarms, prediction time, and kind of probability."""
    return {
        alarm.identifier: {
            f"{time:g}": _rules(points, alarm, time, event_threshold, prior)
            for time in prediction_times_lt
        }
        for alarm in points.alarms
    }


def _rules(
    points: ForecastPoints, alarm: AlarmSource, time: float, threshold: float, prior: float
) -> dict[str, Any]:
    """Records of the rules of one alarm at one prediction time."""
    outcomes = points.outcomes(alarm, time, threshold).total()
    if not alarm.forecasters:  # the values of a baseline are no probabilities
        return {CALIBRATED: AlarmRule.chosen(outcomes, isotonic(outcomes)).record()}
    shares = points.classifier(alarm) is None
    calibrated = isotonic(outcomes, prior) if shares else logistic(outcomes)
    return {
        CALIBRATED: AlarmRule.chosen(outcomes, calibrated).record(),
        VOTES: AlarmRule.chosen(outcomes, UNCALIBRATED).record(),
    }
