"""Score the probabilities of all sources of alarms, and compare them."""

from collections.abc import Mapping
from itertools import combinations

from burstcast.base.declared import at, declaring, made_by
from burstcast.base.resampled_score import median_scores
from burstcast.forecasts.alarms import CALIBRATED
from burstcast.forecasts.scores import resampled_scores
from burstcast.tables.cells import Scores, with_interval
from burstcast.tables.makers._probabilities import CaseProbabilities, case_probabilities
from burstcast.tables.makers.registry import Rows

COMPARED_METRICS = ("brier_skill", "average_precision", "alarm_f_score")


@declaring
def make(
    *, case: CaseProbabilities = made_by(case_probabilities), bins: int = at("probability.bins")
) -> dict[str, Rows]:
    """The scores with their intervals, and paired differences between forecasters."""
    rows: Rows = []
    pairs: Rows = []
    for time in case.times:
        weights = case.weights(time)
        calibrated: dict[str, Scores] = {}
        for alarm in case.alarms:
            probabilities = case.probabilities(alarm, time)
            for probability, (outcomes, threshold) in probabilities.items():
                found_scores = resampled_scores(outcomes, weights, threshold, bins)
                if probability == CALIBRATED:
                    calibrated[alarm.identifier] = found_scores
                keys = {**case.keys(alarm), "probability": probability, "prediction_time_lt": time}
                rows.append({**keys, "metric": "alarm_threshold", "value": threshold})
                rows += [
                    {**keys, "metric": metric, **with_interval(score, case.confidence)}
                    for metric, score in found_scores.items()
                ]
        for (identifier, scores), (other, others) in combinations(_compared(case, calibrated), 2):
            pairs += [
                {
                    "alarm": identifier,
                    "other": other,
                    "prediction_time_lt": time,
                    "metric": metric,
                    **with_interval(scores[metric] - others[metric], case.confidence),
                }
                for metric in COMPARED_METRICS
            ]
    return {"probability_scores": rows, "probability_differences": pairs}


def _compared(case: CaseProbabilities, scores: Mapping[str, Scores]) -> list[tuple[str, Scores]]:
    """Committees before the medians over their members, then all others but single networks."""
    committees = [alarm for alarm in case.alarms if len(alarm.forecasters) > 1]
    medians = []
    for alarm in committees:
        members = [scores[name] for name in alarm.forecasters]
        medians.append((f"median of {alarm.identifier}", median_scores(members)))
    others = [alarm for alarm in case.compared if alarm not in committees]
    compared = [(alarm.identifier, scores[alarm.identifier]) for alarm in committees]
    compared += medians
    compared += [(alarm.identifier, scores[alarm.identifier]) for alarm in others]
    return compared
