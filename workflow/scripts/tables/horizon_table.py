"""Average the prediction horizons of each forecaster over the events."""

from itertools import combinations
from typing import Any

import numpy as np
import pandas as pd

from burstcast import random_streams
from burstcast.arrays import IntArray
from burstcast.files.netcdf import read_netcdf
from burstcast.forecast.horizon_intervals import resampled_averages
from burstcast.statistics.resampled_score import ResampledScore
from burstcast.statistics.resampling import bootstrap_weights
from burstcast_workflow.harness.job import job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.gather import gathered
from burstcast_workflow.jobs.tables import (
    Scores,
    between,
    medians_over_seeds,
    with_interval,
    write_tables,
)

METRICS = ("mean_horizon_lt", "median_horizon_lt")


def _weights(settings: Settings, events: int) -> IntArray:
    """How often each event is in each bootstrap sample, ``(resamples, events)``."""
    resamples = settings["bootstrap.resamples"]
    if events == 0:
        return np.empty((resamples, 0), dtype=np.int64)
    generator = random_streams.stream(
        settings["random_seed"], "bootstrap", settings["case"], "events"
    )
    return bootstrap_weights(events, resamples, generator)


@job
def horizon_table(*, horizons: list[str], tables: list[str], settings: Settings) -> None:
    """Write one row for each forecaster, the intervals of the averages, and paired differences.

    The averages are undefined where there is no event. All forecasters of a case have the same
    events, and the same bootstrap samples of them.
    """
    rows, ends, confidence = [], [], settings["bootstrap.confidence"]
    found = [
        (keys, read_netcdf(origin.path)["prediction_horizon_lt"])
        for keys, origin in gathered(settings, horizons)
    ]
    weights = _weights(settings, len(found[0][1]))
    resampled: list[tuple[dict[str, Any], Scores]] = []
    for keys, values in found:
        events = pd.Series(values)
        averages = dict(zip(METRICS, (events.mean(), events.median()), strict=True))
        rows.append({**keys, "events": len(events), **averages})
        scores = {
            metric: ResampledScore(averages[metric], samples)
            for metric, samples in zip(METRICS, resampled_averages(values, weights), strict=True)
        }
        ends += [
            {**keys, "metric": metric, **between(score.samples, confidence)}
            for metric, score in scores.items()
        ]
        resampled.append((keys, scores))
    pairs = [
        {
            **{"case": settings["case"], "compared": one, "other": other, "metric": metric},
            **with_interval(scores[metric] - others[metric], confidence),
        }
        for (one, scores), (other, others) in combinations(medians_over_seeds(resampled).items(), 2)
        for metric in METRICS
    ]
    write_tables(tables, settings, horizon=rows, horizon_intervals=ends, horizon_differences=pairs)
