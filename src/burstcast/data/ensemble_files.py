"""Ensembles as files: the series that all data of a case come from."""

from typing import Any

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.base.files.netcdf import Variable
from burstcast.base.files.units import COMPONENT, NUMBER, OBSERVABLE, TIME
from burstcast.base.series_lengths import numbers_of, series_lengths

START = "start"
"""Variable of an ensemble of a record: the time of the first sample of each series."""

SCHEDULE = "parameter"
"""Variable of an ensemble of a record with columns that are known in advance: their values."""


def schedule_variable(schedules: FloatArray) -> dict[str, Variable]:
    """Variable of values that are known in advance, ``(series, time - 1, columns)``."""
    meaning = "value of each column that is known in advance, in the sample after each step"
    return {SCHEDULE: Variable(("series", "step", "parameter_name"), schedules, None, meaning)}


def ensemble_variables(
    states: FloatArray,
    observable: FloatArray,
    observable_name: str,
    index: IntArray,
    lifetimes: IntArray,
    sampling_interval: float,
) -> tuple[dict[str, Variable], dict[str, Any]]:
    """Variables of the file of an ensemble, and a summary.

    ``states``, ``observable``: States and observable of the kept series, ``(series, time,
    component)`` and ``(series, time)``; shorter series end with NaN. ``lifetimes``: Steps until
    each of all series laminarised; all steps of a kept one.
    """
    variables = {
        "series": Variable(("series",), index, NUMBER, "number of the series in the ensemble"),
        "lifetime": Variable(
            ("generated",),
            lifetimes,
            NUMBER,
            "steps until each series that was generated laminarised; all of a kept one",
        ),
        "time": Variable(
            ("time",),
            sampling_interval * np.arange(states.shape[1]),
            TIME,
            "time after the transient",
        ),
        "state": Variable(
            ("series", "time", "component"),
            states,
            COMPONENT,
            "state of the system",
            chunks=(1, *states.shape[1:]),
        ),
        "observable": Variable(
            ("series", "time"),
            observable,
            OBSERVABLE,
            observable_name,
            chunks=(1, observable.shape[1]),
        ),
    }
    if (lengths := series_lengths(states)) is not None:
        meaning = "samples of each series, after which it is filled up with NaN"
        variables["length"] = Variable(("series",), lengths, NUMBER, meaning)
    summary = {
        "series_generated": len(lifetimes),
        "series_kept": len(index),
        "laminarised_fraction": 1 - len(index) / len(lifetimes),
        "mean_observable": float(numbers_of(observable).mean()),
    }
    return variables, summary
