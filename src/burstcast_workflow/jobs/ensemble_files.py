"""Ensembles as files: the series that all data of a case come from."""

from collections.abc import Mapping

import numpy as np

from burstcast.arrays import FloatArray, IntArray
from burstcast.netcdf import Variable
from burstcast.units import COMPONENT, NUMBER, OBSERVABLE, TIME
from burstcast_workflow.harness.storage import write_json, write_netcdf


def write_ensemble(
    files: tuple[str, str],
    states: FloatArray,
    observable: FloatArray,
    observable_name: str,
    index: IntArray,
    lifetimes: IntArray,
    sampling_interval: float,
    provenance: Mapping[str, str],
) -> None:
    """Write kept series, their observable, and a summary.

    Parameters
    ----------
    files
        Paths of the ensemble (NetCDF) and of the summary (JSON).
    states, observable
        Of the kept series, ``(series, time, component)`` and ``(series, time)``.
    observable_name
        What the observable is.
    index
        Number of each kept series among all of them.
    lifetimes
        Steps until each of all series laminarised; all steps of a kept one.
    sampling_interval
        Time between two steps, in time units.
    provenance
        Of the job.
    """
    ensemble, summary = files
    write_netcdf(
        ensemble,
        {
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
        },
        provenance,
    )
    write_json(
        summary,
        {
            "series_generated": len(lifetimes),
            "series_kept": len(index),
            "laminarised_fraction": 1 - len(index) / len(lifetimes),
            "mean_observable": float(observable.mean()),
            "provenance": provenance,
        },
    )
