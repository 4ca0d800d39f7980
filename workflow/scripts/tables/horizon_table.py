"""Average the prediction horizons of each forecaster over the events."""

import numpy as np
import pandas as pd

from burstcast import random_streams
from burstcast.arrays import IntArray
from burstcast.forecast.horizon_intervals import resampled_averages
from burstcast.resampling import bootstrap_weights, percentile_interval
from burstcast_workflow.harness.job import run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_netcdf
from burstcast_workflow.harness.tables import keyed_table, write_table
from burstcast_workflow.jobs.gather import gathered


def horizon_table(*, horizons: list[str], table: str, intervals: str, settings: Settings) -> None:
    """Write one row for each forecaster, and the intervals of the averages over the events.

    The averages are undefined where there is no event. All forecasters of a case have the same
    events, and the same bootstrap samples of them.
    """
    rows, ends = [], []
    weights_of: dict[str, IntArray] = {}
    for record, path in gathered(settings["rows"], horizons):
        values = read_netcdf(path)["prediction_horizon_lt"]
        found = pd.Series(values)
        averages = {"mean_horizon_lt": found.mean(), "median_horizon_lt": found.median()}
        rows.append({**record["keys"], "events": len(found), **averages})
        case = record["identity"]["case"]
        if case not in weights_of:
            weights_of[case] = _weights(settings, case, len(values))
        averaged = resampled_averages(values, weights_of[case])
        for metric, samples in zip(averages, averaged, strict=True):
            low, high = percentile_interval(samples, settings["bootstrap.confidence"])
            ends.append({**record["keys"], "metric": metric, "low": low, "high": high})
    write_table(table, keyed_table(rows))
    write_table(intervals, keyed_table(ends))


def _weights(settings: Settings, case: str, events: int) -> IntArray:
    """How often each event of a case is in each bootstrap sample, ``(resamples, events)``."""
    resamples = settings["bootstrap.resamples"]
    if events == 0:
        return np.empty((resamples, 0), dtype=np.int64)
    generator = random_streams.stream(settings["random_seed"], "bootstrap", case, "events")
    return bootstrap_weights(events, resamples, generator)


if __name__ == "__main__":
    run_job(snakemake, horizon_table)  # noqa: F821 - Snakemake puts it there
