"""Lifetimes of series and long runs, as tables read them: nothing here knows any forecaster."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from burstcast.arrays import IntArray
from burstcast.netcdf import read_netcdf
from burstcast.statistics.long_term import Fate
from burstcast.statistics.survival import Lifetimes
from burstcast_workflow.jobs.time_unit import sampling_interval

Settings = Mapping[str, Any]


def long_run_steps(settings: Settings) -> int:
    """Steps of each long run."""
    duration: float = settings["statistics.duration"]
    return round(duration / sampling_interval(settings))


def lifetimes_of_data(ensemble: str) -> Lifetimes:
    """Lifetimes of all series that were generated; those that are not kept have laminarised."""
    data = read_netcdf(ensemble, "series", "lifetime", "time")
    escaped = np.ones(len(data["lifetime"]), dtype=bool)
    escaped[data["series"]] = False
    return Lifetimes(data["lifetime"], escaped, len(data["time"]) - 1)


def lifetimes_of_training(ensemble: str, training: int) -> Lifetimes:
    """Lifetimes of the series that were generated for the training series, and of these.

    Series are kept in the order in which they were generated: all were generated after the last
    one kept before the training series, and up to the last of these.

    Parameters
    ----------
    ensemble
        Path of the ensemble.
    training
        Number of training series, the first of the ensemble.
    """
    kept = read_netcdf(ensemble, "series")["series"]
    whole = lifetimes_of_data(ensemble)
    own = kept[:training]
    first = max(kept[kept < own.min()], default=-1) + 1
    generated = slice(first, own.max() + 1)
    return Lifetimes(whole.steps[generated], whole.escaped[generated], whole.length)


def lifetimes_of_runs(fates: IntArray, lifetimes: IntArray, steps: int) -> Lifetimes:
    """Lifetimes of long runs of so many steps."""
    return Lifetimes(lifetimes, fates != Fate.KEPT, steps)
