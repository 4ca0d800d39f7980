"""Data of diagrams of probabilities: reliability, curves over thresholds."""

from collections.abc import Mapping, Sequence
from typing import Any

from burstcast.probability.alarms import counts_at_all_levels, false_alarm_rate
from burstcast.probability.reliability import reliability_diagram
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
    settings=f"{SETTINGS} probability.bins",
)


def make(
    *,
    forecasts: Sequence[Gathered],
    evaluation_set: Mapping[str, Any],
    calibration: Mapping[str, Any],
    bins: int,
    **scored: Any,
) -> dict[str, Rows]:
    """Two tables, of committees and of all others but single networks."""
    in_bins: Rows = []
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
                whole = outcomes.total()
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
    return {"reliability": in_bins, "alarm_curves": points}
