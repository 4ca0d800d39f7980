"""Data of diagrams of probabilities: reliability, economic value, curves over thresholds."""

from collections.abc import Mapping, Sequence
from typing import Any

from burstcast.probability.alarms import counts_at_all_levels, false_alarm_rate
from burstcast.probability.economic_value import economic_value
from burstcast.probability.reliability import reliability_diagram
from burstcast.statistics.resampled_score import ResampledScore
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
    settings={
        **SETTINGS,
        "bins": "probability.bins",
        "cost_loss_ratios": "probability.cost_loss_ratios",
    },
)


def make(
    *,
    forecasts: Sequence[Gathered],
    evaluation_set: Mapping[str, Any],
    calibration: Mapping[str, Any],
    bins: int,
    cost_loss_ratios: Sequence[float],
    **scored: Any,
) -> dict[str, Rows]:
    """Three tables, of committees and of all others but single networks."""
    in_bins: Rows = []
    ratios: Rows = []
    points: Rows = []
    case = CaseProbabilities.of(forecasts, evaluation_set, calibration, **scored)
    for time in case.times:
        weights = case.weights(time)
        for alarm in case.compared:
            for probability, (outcomes, _) in case.probabilities(alarm, time).items():
                keys = {**case.keys(alarm), "probability": probability, "prediction_time_lt": time}
                diagram = reliability_diagram(
                    outcomes,
                    bins,
                    weights,
                    case.confidence,
                    case.stream("reliability", time, alarm.identifier, probability),
                )
                in_bins += [
                    {
                        **keys,
                        "bin": number,
                        "forecasts": int(diagram.whole.points[number]),
                        "mean_probability": diagram.whole.mean_probability[number],
                        "observed_frequency": diagram.whole.frequency[number],
                        "consistency_low": diagram.low[number],
                        "consistency_high": diagram.high[number],
                    }
                    for number in range(bins)
                ]
                whole, resampled = outcomes.total(), outcomes.resampled(weights)
                for ratio in cost_loss_ratios:
                    saved = ResampledScore(
                        economic_value(whole, ratio), economic_value(resampled, ratio)
                    )
                    cells = with_interval(saved, case.confidence)
                    ratios.append({**keys, "cost_loss_ratio": ratio, **cells})
                counts = counts_at_all_levels(whole)
                points += [
                    {
                        **keys,
                        "threshold": float(level),
                        "false_alarm_rate": float(rate),
                        "recall": float(recall),
                        "precision": float(precision),
                    }
                    for level, rate, recall, precision in zip(
                        whole.levels[::-1],
                        false_alarm_rate(counts),
                        counts.recall,
                        counts.precision,
                        strict=True,
                    )
                ]
    return {"reliability": in_bins, "economic_value": ratios, "alarm_curves": points}
