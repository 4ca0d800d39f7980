"""All scores of probabilities at one prediction time, by name."""

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.resampled_score import ResampledScore
from burstcast.forecasts.alarms import average_precision, counts_at, roc_area
from burstcast.forecasts.brier import (
    base_rate,
    brier_score,
    brier_skill,
    calibration_error,
    decomposition,
)
from burstcast.forecasts.outcomes import Outcomes


def probability_scores(outcomes: Outcomes, threshold: float, bins: int) -> dict[str, FloatArray]:
    """Score probabilities, and the alarms at or above a threshold; NaN where undefined.

    ``outcomes``: Summed over series, ``(levels,)``, or of resamples, ``(resamples, levels)``.
    ``bins``: Of the decomposition and of the calibration error.
    """
    counts = counts_at(outcomes, threshold)
    return {
        "base_rate": base_rate(outcomes),
        "brier_score": brier_score(outcomes),
        "brier_skill": brier_skill(outcomes),
        **decomposition(outcomes, bins),
        "calibration_error": calibration_error(outcomes, bins),
        "roc_area": roc_area(outcomes),
        "average_precision": average_precision(outcomes),
        "alarm_precision": counts.precision,
        "alarm_recall": counts.recall,
        "alarm_f_score": counts.f_score,
    }


def resampled_scores(
    outcomes: Outcomes, weights: IntArray, threshold: float, bins: int
) -> dict[str, ResampledScore]:
    """`probability_scores` of all series, ``(series, levels)``, and of resamples of them."""
    values = probability_scores(outcomes.total(), threshold, bins)
    samples = probability_scores(outcomes.resampled(weights), threshold, bins)
    return {name: ResampledScore(value, samples[name]) for name, value in values.items()}
