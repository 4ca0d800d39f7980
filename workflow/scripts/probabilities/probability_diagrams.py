"""What diagrams of probabilities show: reliability, economic value, curves over all thresholds."""

from typing import Any

from burstcast.probability.alarms import counts_at_all_levels, false_alarm_rate
from burstcast.probability.economic_value import economic_value
from burstcast.probability.reliability import reliability_diagram
from burstcast.statistics.resampled_score import ResampledScore
from burstcast_workflow.harness.job import job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.probabilities import case_probabilities
from burstcast_workflow.jobs.tables import with_interval, write_tables


@job
def draw_up_diagrams(
    *,
    forecasts: list[str],
    evaluation_set: str,
    calibration: str,
    tables: list[str],
    settings: Settings,
) -> None:
    """Write three tables, of committees and of all others but single networks."""
    confidence = settings["bootstrap.confidence"]
    bins: list[dict[str, Any]] = []
    ratios: list[dict[str, Any]] = []
    points: list[dict[str, Any]] = []
    case = case_probabilities(settings, forecasts, evaluation_set, calibration)
    for time in settings["classification.prediction_times_lt"]:
        weights = case.weights(time)
        for alarm in case.compared:
            for probability, (outcomes, _) in case.probabilities(alarm, time).items():
                keys = {**case.keys(alarm), "probability": probability, "prediction_time_lt": time}
                diagram = reliability_diagram(
                    outcomes,
                    settings["probability.bins"],
                    weights,
                    confidence,
                    case.stream("reliability", time, alarm.identifier, probability),
                )
                bins += [
                    {
                        **keys,
                        "bin": number,
                        "forecasts": int(diagram.whole.points[number]),
                        "mean_probability": diagram.whole.mean_probability[number],
                        "observed_frequency": diagram.whole.frequency[number],
                        "consistency_low": diagram.low[number],
                        "consistency_high": diagram.high[number],
                    }
                    for number in range(settings["probability.bins"])
                ]
                whole, resampled = outcomes.total(), outcomes.resampled(weights)
                for ratio in settings["probability.cost_loss_ratios"]:
                    saved = ResampledScore(
                        economic_value(whole, ratio), economic_value(resampled, ratio)
                    )
                    cells = with_interval(saved, confidence)
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
    write_tables(tables, settings, reliability=bins, economic_value=ratios, alarm_curves=points)
