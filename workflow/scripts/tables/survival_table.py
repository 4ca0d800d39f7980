"""How long the data and the forecasters' long runs stay in the chaotic phase."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from burstcast.files.netcdf import read_netcdf
from burstcast.statistics.long_term import Fate
from burstcast.statistics.survival import Lifetimes, escape_rate, survival_curve
from burstcast_workflow.harness.job import job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.gather import case_keys, gathered
from burstcast_workflow.jobs.tables import with_ends, write_tables
from burstcast_workflow.jobs.time_unit import long_run_steps, sampling_interval

POINTS = 101
"""Times at which the survival curve is tabulated, from zero to the end."""


def _rate(lifetimes: Lifetimes, interval: float, confidence: float) -> Mapping[str, Any]:
    rate = escape_rate(lifetimes, interval, confidence)
    return {
        "series": len(lifetimes.steps),
        "survived_fraction": float((~lifetimes.escaped).mean()),
        "escapes": rate.escapes,
        "time_at_risk": rate.time_at_risk,
        **with_ends("escape_rate", rate.rate, rate.low, rate.high),
    }


@job
def survival_table(
    *, ensemble: str, long_term: list[str], tables: list[str], settings: Settings
) -> None:
    """Write the escape rate of the data and of each forecaster, and their survival curves."""
    of_case = {**case_keys(settings), "forecaster": "data", "neurons": None}
    data = read_netcdf(ensemble, "series", "lifetime", "time")
    of_data = Lifetimes.of_ensemble(data["lifetime"], data["series"], len(data["time"]) - 1)
    found = [({**of_case, "validation": None, "seed": None}, of_data)]
    steps = long_run_steps(settings, ensemble)
    for keys, origin in gathered(settings, long_term):
        runs = read_netcdf(origin.path, "fate", "lifetime")
        found.append((keys, Lifetimes(runs["lifetime"], runs["fate"] != Fate.KEPT, steps)))
    rows, points = [], []
    interval = sampling_interval(settings)
    for keys, lifetimes in found:
        rows.append({**keys, **_rate(lifetimes, interval, settings["bootstrap.confidence"])})
        times = np.unique(np.linspace(0, lifetimes.length, POINTS).astype(np.int64))
        curve = survival_curve(lifetimes, times, settings["bootstrap.confidence"])
        points += [
            {**keys, "time": time * interval, **with_ends("survival", *ends)}
            for time, *ends in zip(times, curve.share, curve.low, curve.high, strict=True)
        ]
    write_tables(tables, settings, survival=rows, survival_curve=points)
