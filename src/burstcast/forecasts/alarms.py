"""Alarms: calibrated probabilities, the alarm threshold, the rules of all sources of a case.

A calibration maps forecast values to frequencies of events in past forecasts. Isotonic regression
is the best non-decreasing map in the sense of least squares, found by pooling adjacent violators
(Ayer et al., Annals of Mathematical Statistics 26, 1955; for forecasts Zadrozny & Elkan, KDD 2002).
Ten training series hold few events, so that frequencies of rare values are mostly chance: a beta
prior at each value counts like forecasts that came true with this frequency.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray
from burstcast.forecasts.points import AlarmSource, ForecastPoints
from burstcast.forecasts.scores import Outcomes, best_threshold, ratio


@dataclass(frozen=True)
class Calibration:
    """A map from forecast values to probabilities, linear between its knots, constant beyond."""

    values: FloatArray  #: knots, rising, ``(knots,)``
    #: probability of an event at each of them, never falling, ``(knots,)``
    probabilities: FloatArray

    def __call__(self, values: FloatArray) -> FloatArray:
        """Probability of an event for each forecast value; NaN without any knot."""
        if not self.values.size:
            return np.full(np.shape(values), np.nan)
        return np.asarray(np.interp(values, self.values, self.probabilities))


UNCALIBRATED = Calibration(np.array([0.0, 1.0]), np.array([0.0, 1.0]))
"""The identity: a share of votes is the probability."""


def pool_adjacent_violators(values: FloatArray, weights: FloatArray) -> FloatArray:
    """Non-decreasing sequence nearest to ``(count,)`` values, by weighted least squares."""
    means: list[float] = []
    sizes: list[float] = []
    lengths: list[int] = []
    for value, weight in zip(values.tolist(), weights.tolist(), strict=True):
        mean, size, length = value, weight, 1
        while means and means[-1] >= mean:
            whole = sizes[-1] + size
            mean = (sizes.pop() * means.pop() + size * mean) / whole
            size, length = whole, length + lengths.pop()
        means.append(mean)
        sizes.append(size)
        lengths.append(length)
    return np.repeat(np.array(means), lengths)


def isotonic(outcomes: Outcomes, prior: float = 0.0) -> Calibration:
    """Calibrate by isotonic regression of the outcomes on the forecast values.

    ``prior``: Number of forecasts at each value that the prior counts for: forecasts that came true
    with this value as their frequency, so that values must be probabilities. 0: the regression
    alone.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.forecasts.alarms import isotonic
    >>> from burstcast.forecasts.scores import Outcomes
    >>> votes = Outcomes(np.array([0.0, 0.5, 1.0]), np.array([80, 10, 10]), np.array([4, 3, 9]))
    >>> isotonic(votes)(np.array([0.0, 0.5, 1.0])).round(2).tolist()
    [0.05, 0.3, 0.9]
    """
    if not 0 <= prior < np.inf:
        raise ValueError(f"a prior counts as 0 forecasts or more, not as {prior}")
    weights = outcomes.points + np.float64(prior)
    frequency = ratio(outcomes.events + prior * outcomes.levels, weights)
    if not outcomes.levels.size:
        return Calibration(np.empty(0), np.empty(0))
    fitted = pool_adjacent_violators(frequency, weights)
    # the ends of each constant stretch suffice
    ends = np.concatenate([[True], np.diff(fitted) != 0, [True]])
    knots = ends[:-1] | ends[1:]
    return Calibration(outcomes.levels[knots], fitted[knots])


def logistic(outcomes: Outcomes) -> Calibration:
    """Calibrate probabilities by logistic regression of the outcomes on their log-odds.

    A smooth map, for classifiers, whose probabilities are all different. Source: Platt, in Advances
    in Large Margin Classifiers, MIT Press 1999, with his targets, which keep the regression finite
    where events are separated completely. Where events have no larger probabilities than quiet
    points, all probabilities become the base rate.
    """
    if not outcomes.levels.size:
        return Calibration(np.empty(0), np.empty(0))
    points, events = outcomes.points, outcomes.events
    happened, quiet = int(events.sum()), int((points - events).sum())
    # targets of events and of quiet points, and their sum at each level
    high, low = (happened + 1) / (happened + 2), 1 / (quiet + 2)
    wanted = events * high + (points - events) * low
    ends = _probability(np.array([-_LARGEST_LOG_ODDS, _LARGEST_LOG_ODDS]))
    odds = _log_odds(np.clip(outcomes.levels, *ends))
    design = np.stack([odds, np.ones_like(odds)])
    parameters = np.array([0.0, _log_odds(wanted.sum() / points.sum())])
    for _ in range(_NEWTON_STEPS):
        fitted = _probability(parameters @ design)
        gradient = design @ (wanted - points * fitted)
        curvature = (design * (points * fitted * (1 - fitted))) @ design.T
        step = np.linalg.lstsq(curvature, gradient, rcond=None)[0]
        parameters = parameters + step / max(1.0, float(np.abs(step).max()))
    if parameters[0] <= 0:
        parameters = np.array([0.0, _log_odds(wanted.sum() / points.sum())])
    knots = np.linspace(-_LARGEST_LOG_ODDS, _LARGEST_LOG_ODDS, _KNOTS)
    probabilities = _probability(parameters[0] * knots + parameters[1])
    return Calibration(_probability(knots), probabilities)


_LARGEST_LOG_ODDS, _KNOTS = 25.0, 501
"""Range and number of the knots of a logistic calibration, evenly spaced in log-odds."""
_NEWTON_STEPS = 60


def _log_odds(probability: Any) -> Any:
    return np.log(probability) - np.log1p(-probability)


def _probability(log_odds: FloatArray) -> FloatArray:
    return np.asarray(1.0 / (1.0 + np.exp(-log_odds)))


CALIBRATED, VOTES = "calibrated", "votes"
"""What tables call calibrated probabilities, and shares of votes as they are."""


@dataclass(frozen=True)
class AlarmRule:
    """Rule of alarms: a calibration and the alarm threshold."""

    calibration: Calibration  #: function from what is forecast to the probability
    threshold: float

    @classmethod
    def chosen(cls, outcomes: Outcomes, calibration: Calibration) -> Self:
        """Rule with the best threshold for a calibration, by outcomes summed over series."""
        levels = outcomes.at(calibration(outcomes.levels))
        return cls(calibration, best_threshold(levels.levels, levels.points))

    def alarms(self, values: FloatArray) -> BoolArray:
        """Whether an alarm is raised, by what is forecast; never without a calibration."""
        return np.asarray(self.calibration(values) >= self.threshold)

    def record(self) -> dict[str, Any]:
        """Lists and numbers from which `restore` recreates the rule."""
        return {
            "values": self.calibration.values.tolist(),
            "probabilities": self.calibration.probabilities.tolist(),
            "threshold": self.threshold,
        }

    @classmethod
    def restore(cls, record: Mapping[str, Any]) -> Self:
        """Make a rule from its record."""
        calibration = Calibration(np.array(record["values"]), np.array(record["probabilities"]))
        return cls(calibration, record["threshold"])


def rules_of(
    chosen: Mapping[str, Any], alarm: str, prediction_time_lt: float
) -> dict[str, AlarmRule]:
    """Rules of an alarm: by `CALIBRATED` probabilities, and, if it has any, by `VOTES`."""
    records = chosen["alarms"][alarm][f"{prediction_time_lt:g}"]
    return {name: AlarmRule.restore(record) for name, record in records.items()}


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
