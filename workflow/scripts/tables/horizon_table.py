"""Average the prediction horizons of each forecaster over the events."""

from itertools import combinations
from typing import Any

import numpy as np
import pandas as pd

from burstcast import random_streams
from burstcast.arrays import FloatArray, IntArray
from burstcast.forecast.horizon_intervals import resampled_averages
from burstcast.resampling import bootstrap_weights, percentile_interval
from burstcast_workflow.harness.job import run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_netcdf
from burstcast_workflow.harness.tables import keyed_table, write_table
from burstcast_workflow.identifiers import ForecasterName
from burstcast_workflow.jobs.gather import gathered

METRICS = ("mean_horizon_lt", "median_horizon_lt")
DIFFERENCES = ("case", "compared", "other", "metric", "value", "low", "high")

# By metric: the average over all events, and those of the bootstrap samples.
Averages = dict[str, tuple[float, FloatArray]]


def horizon_table(
    *, horizons: list[str], table: str, intervals: str, differences: str, settings: Settings
) -> None:
    """Write one row for each forecaster, the intervals of the averages, and paired differences.

    The averages are undefined where there is no event. All forecasters of a case have the same
    events, and the same bootstrap samples of them.
    """
    rows, ends = [], []
    confidence = settings["bootstrap.confidence"]
    weights_of: dict[str, IntArray] = {}
    # by case, and by what networks that differ by their seeds have in common
    found: dict[str, dict[ForecasterName, list[tuple[str, Averages]]]] = {}
    for record, path in gathered(settings["rows"], horizons):
        values, keys = read_netcdf(path)["prediction_horizon_lt"], record["keys"]
        events = pd.Series(values)
        averages = dict(zip(METRICS, (events.mean(), events.median()), strict=True))
        rows.append({**keys, "events": len(events), **averages})
        case, forecaster = (record["identity"][name] for name in ("case", "forecaster"))
        if case not in weights_of:
            weights_of[case] = _weights(settings, case, len(values))
        samples = dict(zip(METRICS, resampled_averages(values, weights_of[case]), strict=True))
        for metric in METRICS:
            low, high = percentile_interval(samples[metric], confidence)
            ends.append({**keys, "metric": metric, "low": low, "high": high})
        common = ForecasterName(keys["forecaster"], keys["neurons"], keys["validation"])
        pair = {metric: (averages[metric], samples[metric]) for metric in METRICS}
        found.setdefault(case, {}).setdefault(common, []).append((forecaster, pair))
    pairs = [row for case, who in found.items() for row in _differences(case, who, confidence)]
    write_table(table, keyed_table(rows))
    write_table(intervals, keyed_table(ends))
    write_table(differences, pd.DataFrame(pairs, columns=list(DIFFERENCES)))


def _differences(
    case: str, who: dict[ForecasterName, list[tuple[str, Averages]]], confidence: float
) -> list[dict[str, Any]]:
    """Differences between any two, networks that differ by their seeds being one: their median."""
    compared = [
        (
            members[0][0] if len(members) == 1 else f"median of {common.identifier}",
            {metric: _median([averages[metric] for _, averages in members]) for metric in METRICS},
        )
        for common, members in who.items()
    ]
    rows = []
    for (one, averages), (other, others) in combinations(compared, 2):
        for metric in METRICS:
            (value, samples), (less, fewer) = averages[metric], others[metric]
            low, high = percentile_interval(samples - fewer, confidence)
            row = (case, one, other, metric, value - less, low, high)
            rows.append(dict(zip(DIFFERENCES, row, strict=True)))
    return rows


def _median(members: list[tuple[float, FloatArray]]) -> tuple[float, FloatArray]:
    """Median over networks, in each sample."""
    values, samples = zip(*members, strict=True)
    return float(np.median(values)), np.median(samples, axis=0)


def _weights(settings: Settings, case: str, events: int) -> IntArray:
    """How often each event of a case is in each bootstrap sample, ``(resamples, events)``."""
    resamples = settings["bootstrap.resamples"]
    if events == 0:
        return np.empty((resamples, 0), dtype=np.int64)
    generator = random_streams.stream(settings["random_seed"], "bootstrap", case, "events")
    return bootstrap_weights(events, resamples, generator)


if __name__ == "__main__":
    run_job(snakemake, horizon_table)  # noqa: F821 - Snakemake puts it there
