"""Average the prediction horizons of each forecaster over the events."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from burstcast.base import random_streams
from burstcast.base.declared import at, declaring, gathered
from burstcast.base.names import ForecasterName
from burstcast.base.resampled_score import ResampledScore
from burstcast.base.resampling import bootstrap_weights
from burstcast.forecasts.horizon import resampled_averages
from burstcast.tables.cells import Scores, between, medians_over_seeds, with_interval
from burstcast.tables.makers.registry import Gathered, Rows

METRICS = ("mean_horizon_lt", "median_horizon_lt")


@declaring
def make(
    *,
    horizons: Sequence[Gathered] = gathered(
        "trajectory_forecasters/horizon.nc", "prediction_horizon_lt"
    ),
    case: str = at("case"),
    root_seed: int = at("random_seed"),
    resamples: int = at("bootstrap.resamples"),
    confidence: float = at("bootstrap.confidence"),
) -> dict[str, Rows]:
    """One row for each forecaster, the intervals of the averages, and paired differences.

    The averages are undefined where there is no event. All forecasters of a case have the same
    events, and the same bootstrap samples of them.
    """
    import pandas as pd  # planning reads what is declared alone

    events = max((len(file.content["prediction_horizon_lt"]) for file in horizons), default=0)
    weights = np.empty((resamples, 0), dtype=np.int64)
    if events:
        generator = random_streams.stream(root_seed, "bootstrap", case, "events")
        weights = bootstrap_weights(events, resamples, generator)
    rows: Rows = []
    ends: Rows = []
    resampled: list[tuple[ForecasterName, Scores]] = []
    for file in horizons:
        values = file.content["prediction_horizon_lt"]
        series = pd.Series(values)
        averages = dict(zip(METRICS, (series.mean(), series.median()), strict=True))
        rows.append({**file.name.keys, "events": events, **averages})
        scores = {
            metric: ResampledScore(averages[metric], samples)
            for metric, samples in zip(METRICS, resampled_averages(values, weights), strict=True)
        }
        ends += [
            {**file.name.keys, "metric": metric, **between(score.samples, confidence)}
            for metric, score in scores.items()
        ]
        resampled.append((file.name, scores))
    of_forecasters = medians_over_seeds(resampled).items()
    pairs = [
        {
            **{"compared": compared, "other": other, "metric": metric},
            **with_interval(scores[metric] - others[metric], confidence),
        }
        for (compared, scores), (other, others) in combinations(of_forecasters, 2)
        for metric in METRICS
    ]
    return {"horizon": rows, "horizon_intervals": ends, "horizon_differences": pairs}
