"""Score alarms for other event thresholds, which forecasts do not know of."""

from itertools import product
from typing import Any

from burstcast.probability.scores import resampled_scores
from burstcast_workflow.harness.job import job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.probabilities import CALIBRATED, case_probabilities
from burstcast_workflow.jobs.tables import with_interval, write_tables

METRICS = ("base_rate", "brier_skill", "average_precision", "f_score")


@job
def sweep_threshold(
    *,
    forecasts: list[str],
    evaluation_set: str,
    calibration: str,
    tables: list[str],
    settings: Settings,
) -> None:
    """Write scores by event threshold, of committees and of all others but single networks."""
    bins, confidence = settings["probability.bins"], settings["bootstrap.confidence"]
    rows: list[dict[str, Any]] = []
    case = case_probabilities(settings, forecasts, evaluation_set, calibration)
    for time in settings["classification.prediction_times_lt"]:
        weights = case.weights(time)
        for alarm, factor in product(case.compared, settings["probability.threshold_factors"]):
            outcomes, threshold = case.probabilities(alarm, time, factor)[CALIBRATED]
            scores = resampled_scores(outcomes, weights, threshold, bins)
            keys = {
                **case.keys(alarm),
                "event_threshold": factor * settings["case.event_threshold"],
                "prediction_time_lt": time,
            }
            rows += [
                {**keys, "metric": metric, **with_interval(scores[metric], confidence)}
                for metric in METRICS
            ]
    write_tables(tables, settings, threshold_sweep=rows)
