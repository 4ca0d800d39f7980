"""Calibrations and alarm thresholds of all sources of alarms in a case."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from burstcast.probability.alarm_rule import CALIBRATED, VOTES, AlarmRule
from burstcast.probability.alarm_sources import AlarmSource
from burstcast.probability.calibration import UNCALIBRATED, isotonic, logistic
from burstcast.probability.forecast_points import ForecastPoints


def calibrated_alarms(
    points: ForecastPoints,
    prediction_times_lt: Sequence[float],
    event_threshold: float,
    factors: Iterable[float],
    prior: float,
) -> dict[str, Any]:
    """Rules of the alarms of all sources (`burstcast.probability.alarm_rule.rules_of`).

    ``event_threshold``, ``factors``: The case's event threshold, and others as multiples of it,
    which are for compared forecasters alone. ``prior``: Weight of the prior of `isotonic`, for
    shares of votes. Returns records of `AlarmRule` by source, factor, prediction time, and kind of
    probability.
    """
    alarms: dict[str, Any] = {}
    for alarm in points.alarms:
        for factor in sorted({1.0, *(factors if alarm.compared else ())}):
            threshold = factor * event_threshold
            if points.knows(alarm, threshold):
                alarms.setdefault(alarm.identifier, {})[f"{factor:g}"] = {
                    f"{time:g}": _rules(points, alarm, time, threshold, prior)
                    for time in prediction_times_lt
                }
    return alarms


def uncalibrated_alarms(
    alarm_thresholds: Mapping[str, float],
    prediction_times_lt: Sequence[float],
    factors: Iterable[float],
) -> dict[str, Any]:
    """Rules of sources whose probabilities are taken as they are, by their alarm thresholds."""
    times, multiples = [*prediction_times_lt], sorted({1.0, *factors})
    found = {}
    for identifier, threshold in alarm_thresholds.items():
        rule = AlarmRule(UNCALIBRATED, threshold).record()
        of_times = {f"{time:g}": {CALIBRATED: rule, VOTES: rule} for time in times}
        found[identifier] = {f"{factor:g}": of_times for factor in multiples}
    return found


def _rules(
    points: ForecastPoints, alarm: AlarmSource, time: float, threshold: float, prior: float
) -> dict[str, Any]:
    """Records of the rules of one alarm, at one prediction time and event threshold."""
    outcomes = points.outcomes(alarm, time, threshold).total()
    if not alarm.forecasters:  # what a baseline is raised by is no probability
        return {CALIBRATED: AlarmRule.chosen(outcomes, isotonic(outcomes)).record()}
    shares = points.classifier(alarm) is None
    calibrated = isotonic(outcomes, prior) if shares else logistic(outcomes)
    return {
        CALIBRATED: AlarmRule.chosen(outcomes, calibrated).record(),
        VOTES: AlarmRule.chosen(outcomes, UNCALIBRATED).record(),
    }
