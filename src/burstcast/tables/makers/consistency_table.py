"""Score forecasts after washouts like those of the training series, and after the others."""

from collections.abc import Sequence

import numpy as np

from burstcast.base.arrays import BoolArray, IntArray
from burstcast.base.declared import at, declaring, gathered, made_by
from burstcast.base.resampled_score import ResampledScore
from burstcast.event_forecaster.consistency import ALPHA
from burstcast.forecasts.alarms import CALIBRATED
from burstcast.forecasts.scores import ratio, resampled_scores
from burstcast.tables.cells import with_interval
from burstcast.tables.makers._probabilities import CaseProbabilities, case_probabilities
from burstcast.tables.makers.registry import Gathered, Rows

SCORED = ("base_rate", "brier_skill", "roc_area", "alarm_f_score")
"""Scores of the table, of calibrated probabilities."""


@declaring
def make(
    *,
    case: CaseProbabilities = made_by(case_probabilities),
    tests: Sequence[Gathered] = gathered("consistency_forecasters/consistency.nc"),
    bins: int = at("probability.bins"),
) -> dict[str, Rows]:
    """Shares and scores by consistency, with intervals over the test series.

    A committee of networks has the test of its first network. Points at which an event is under way
    count nowhere.
    """
    p_values = {each.name.identifier: each.content["p_value"] for each in tests}
    quiet, rows = case.points.scored(case.event_threshold), []
    for alarm in case.alarms:
        known = next((p_values[name] for name in alarm.forecasters if name in p_values), None)
        if known is None or np.isnan(known).any():
            continue
        for name, chosen in (("consistent", known > ALPHA), ("inconsistent", known <= ALPHA)):
            here, others = (_in_series(case, among) for among in (quiet & chosen, quiet))
            for time in case.times:
                weights = case.weights(time)
                outcomes, threshold = case.probabilities(alarm, time, chosen)[CALIBRATED]
                scores = resampled_scores(outcomes, weights, threshold, bins)
                resampled = ratio(weights @ here, weights @ others)
                share = ResampledScore(ratio(here.sum(), others.sum()), resampled)
                keys = {**case.keys(alarm), "prediction_time_lt": time, "washouts": name}
                rows += [
                    {**keys, "metric": metric, **with_interval(score, case.confidence)}
                    for metric, score in (
                        ("washout_fraction", share),
                        *((metric, scores[metric]) for metric in SCORED),
                    )
                ]
    return {"consistency": rows}


def _in_series(case: CaseProbabilities, points: BoolArray) -> IntArray:
    """Number of some points in each series, ``(series,)``."""
    series = case.points.data["series"]
    return np.bincount(series[points], minlength=case.points.series).astype(np.int64)
