"""Score the probabilities of all who raise alarms, and compare them with one another."""

from itertools import combinations
from typing import Any

from burstcast.probability.scores import resampled_scores
from burstcast.statistics.resampled_score import ResampledScore, median_scores
from burstcast_workflow.harness.job import job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.probabilities import (
    CALIBRATED,
    CaseProbabilities,
    case_probabilities,
)
from burstcast_workflow.jobs.tables import with_interval, write_tables

COMPARED_METRICS = ("brier_skill", "average_precision", "f_score")

Scores = dict[str, ResampledScore]


def _compared(case: CaseProbabilities, scores: dict[str, Scores]) -> list[tuple[str, Scores]]:
    """Committees before the medians over their members, then all others but single networks."""
    committees = [alarm for alarm in case.alarms if len(alarm.forecasters) > 1]
    others = [alarm.identifier for alarm in case.compared if alarm not in committees]
    return [
        *((one.identifier, scores[one.identifier]) for one in committees),
        *(
            (
                f"median of {one.identifier}",
                median_scores([scores[name] for name in one.forecasters]),
            )
            for one in committees
        ),
        *((name, scores[name]) for name in others),
    ]


@job
def score_probabilities(
    *,
    forecasts: list[str],
    evaluation_set: str,
    calibration: str,
    tables: list[str],
    settings: Settings,
) -> None:
    """Write the scores with their intervals, and paired differences between forecasters."""
    bins, confidence = settings["probability.bins"], settings["bootstrap.confidence"]
    rows: list[dict[str, Any]] = []
    pairs: list[dict[str, Any]] = []
    case = case_probabilities(settings, forecasts, evaluation_set, calibration)
    for time in settings["classification.prediction_times_lt"]:
        weights = case.weights(time)
        calibrated: dict[str, Scores] = {}
        for alarm in case.alarms:
            found = case.probabilities(alarm, time)
            for probability, (outcomes, threshold) in found.items():
                scores = resampled_scores(outcomes, weights, threshold, bins)
                if probability == CALIBRATED:
                    calibrated[alarm.identifier] = scores
                keys = {**case.keys(alarm), "probability": probability, "prediction_time_lt": time}
                rows.append({**keys, "metric": "alarm_threshold", "value": threshold})
                rows += [
                    {**keys, "metric": metric, **with_interval(score, confidence)}
                    for metric, score in scores.items()
                ]
        for (one, scores), (other, others) in combinations(_compared(case, calibrated), 2):
            pairs += [
                {
                    "case": settings["case"],
                    "alarm": one,
                    "other": other,
                    "prediction_time_lt": time,
                    "metric": metric,
                    **with_interval(scores[metric] - others[metric], confidence),
                }
                for metric in COMPARED_METRICS
            ]
    write_tables(tables, settings, probability_scores=rows, probability_differences=pairs)
