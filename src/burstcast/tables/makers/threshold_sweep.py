"""Score alarms for other event thresholds; forecasts are unchanged."""

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

from burstcast.probability.alarm_rule import CALIBRATED
from burstcast.probability.scores import resampled_scores
from burstcast.tables.cells import with_interval
from burstcast.tables.makers._probabilities import (
    GATHERED,
    INPUTS,
    SETTINGS,
    CaseProbabilities,
)
from burstcast.tables.makers.registry import Declaration, Gathered, Rows

TABLES = Declaration(
    inputs=INPUTS,
    gathered=GATHERED,
    settings={**SETTINGS, "bins": "probability.bins", "factors": "probability.threshold_factors"},
)

METRICS = ("base_rate", "brier_skill", "average_precision", "f_score")


def make(
    *,
    forecasts: Sequence[Gathered],
    evaluation_set: Mapping[str, Any],
    calibration: Mapping[str, Any],
    bins: int,
    factors: Sequence[float],
    **scored: Any,
) -> dict[str, Rows]:
    """Scores by event threshold, of committees and of all others but single networks.

    A classifier has rows of the event that it has learnt alone.
    """
    case = CaseProbabilities.of(forecasts, evaluation_set, calibration, **scored)
    rows: Rows = []
    for time in case.times:
        weights = case.weights(time)
        for alarm, factor in product(case.compared, factors):
            if not case.points.knows(alarm, factor * case.event_threshold):
                continue
            outcomes, threshold = case.probabilities(alarm, time, factor)[CALIBRATED]
            scores = resampled_scores(outcomes, weights, threshold, bins)
            keys = {
                **case.keys(alarm),
                "event_threshold": factor * case.event_threshold,
                "prediction_time_lt": time,
            }
            rows += [
                {**keys, "metric": metric, **with_interval(scores[metric], case.confidence)}
                for metric in METRICS
            ]
    return {"threshold_sweep": rows}
