"""Score the probabilities of all who raise alarms, and compare them with one another."""

from itertools import combinations
from typing import Any

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.probability.scores import probability_scores
from burstcast_workflow.harness.job import run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.tables import write_rows
from burstcast_workflow.jobs.intervals import with_interval
from burstcast_workflow.jobs.probabilities import (
    CALIBRATED,
    CaseProbabilities,
    case_probabilities,
)

COMPARED_METRICS = ("brier_skill", "average_precision", "f_score")

# By metric: the value, and those of the resamples.
Scores = dict[str, tuple[FloatArray, FloatArray]]


def score_probabilities(
    *,
    forecasts: list[str],
    member_forecasts: list[str],
    evaluation_set: str,
    calibration: str,
    table: str,
    differences: str,
    settings: Settings,
) -> None:
    """Write the scores with their intervals, and paired differences between forecasters."""
    bins, confidence = settings["probability.bins"], settings["bootstrap.confidence"]
    rows: list[dict[str, Any]] = []
    pairs: list[dict[str, Any]] = []
    case = case_probabilities(settings, forecasts, member_forecasts, evaluation_set, calibration)
    for time in settings["classification.prediction_times_lt"]:
        weights = case.weights(time)
        calibrated: dict[str, Scores] = {}
        for alarm in case.alarms:
            found = case.probabilities(alarm, time)
            for probability, (outcomes, threshold) in found.items():
                values = probability_scores(outcomes.total(), threshold, bins)
                samples = probability_scores(outcomes.resampled(weights), threshold, bins)
                scores = {metric: (values[metric], samples[metric]) for metric in values}
                if probability == CALIBRATED:
                    calibrated[alarm["alarm"]] = scores
                keys = {**alarm["keys"], "probability": probability, "prediction_time_lt": time}
                rows.append({**keys, "metric": "alarm_threshold", "value": threshold})
                rows += [
                    {**keys, "metric": metric, **with_interval(value, sample, confidence)}
                    for metric, (value, sample) in scores.items()
                ]
        for (one, scores), (other, others) in combinations(_compared(case, calibrated), 2):
            pairs += [
                {
                    "case": settings["case"],
                    "alarm": one,
                    "other": other,
                    "prediction_time_lt": time,
                    "metric": metric,
                    **with_interval(
                        scores[metric][0] - others[metric][0],
                        scores[metric][1] - others[metric][1],
                        confidence,
                    ),
                }
                for metric in COMPARED_METRICS
            ]
    write_rows(table, rows)
    write_rows(differences, pairs)


def _compared(case: CaseProbabilities, scores: dict[str, Scores]) -> list[tuple[str, Scores]]:
    """Committees before the medians over their members, then all others but single networks."""
    committees = [alarm for alarm in case.alarms if len(alarm["members"]) > 1]
    others = [alarm["alarm"] for alarm in case.compared]
    others = [name for name in others if name not in {one["alarm"] for one in committees}]
    return [
        *((one["alarm"], scores[one["alarm"]]) for one in committees),
        *(
            (f"median of {one['alarm']}", _median([scores[name] for name in one["members"]]))
            for one in committees
        ),
        *((name, scores[name]) for name in others),
    ]


def _median(members: list[Scores]) -> Scores:
    """Median over the members of a committee, in each resample."""
    return {
        metric: (
            np.median([member[metric][0] for member in members], axis=0),
            np.median([member[metric][1] for member in members], axis=0),
        )
        for metric in COMPARED_METRICS
    }


if __name__ == "__main__":
    run_job(snakemake, score_probabilities)  # noqa: F821 - Snakemake puts it there
