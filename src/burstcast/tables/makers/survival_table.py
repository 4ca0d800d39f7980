"""Survival of the data and of the forecasters' long runs in the chaotic phase."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from burstcast.base.declared import at, declaring, gathered, read
from burstcast.base.names import ForecasterName
from burstcast.statistics.long_term import Fate
from burstcast.statistics.survival import Lifetimes, escape_rate, survival_curve
from burstcast.tables.cells import with_ends
from burstcast.tables.makers.registry import Gathered, Rows

POINTS = 101
"""Times at which the survival curve is tabulated, from zero to the end."""


@declaring
def make(
    *,
    ensemble: Mapping[str, Any] = read("case/ensemble.nc", "series lifetime time"),
    long_term: Sequence[Gathered] = gathered("long_term_forecasters/long_term.nc", "fate lifetime"),
    time_step: float = at("case.ensemble.time_step"),
    sampling_stride: int = at("case.ensemble.sampling_stride"),
    duration: float | None = at("statistics.duration"),
    confidence: float = at("bootstrap.confidence"),
) -> dict[str, Rows]:
    """The escape rate of the data and of each forecaster, and their survival curves."""
    interval = float(time_step * sampling_stride)
    longest = len(ensemble["time"]) - 1
    # discarded series have escaped
    escaped = np.ones(len(ensemble["lifetime"]), dtype=bool)
    escaped[ensemble["series"]] = False
    of_data = Lifetimes(ensemble["lifetime"], escaped, longest)
    lifetimes_of = [(ForecasterName("data"), of_data)]
    # as long as a series of the ensemble where no duration is known
    steps = longest if duration is None else round(duration / interval)
    for file in long_term:
        lifetimes = Lifetimes(file.content["lifetime"], file.content["fate"] != Fate.KEPT, steps)
        lifetimes_of.append((file.name, lifetimes))
    rows: Rows = []
    points: Rows = []
    for name, lifetimes in lifetimes_of:
        rate = escape_rate(lifetimes, interval, confidence)
        row = {
            "series": len(lifetimes.steps),
            "survived_fraction": float((~lifetimes.escaped).mean()),
            "escapes": rate.escapes,
            "time_at_risk": rate.time_at_risk,
            **with_ends("escape_rate", rate.rate, rate.low, rate.high),
        }
        rows.append({**name.keys, **row})
        times = np.unique(np.linspace(0, lifetimes.length, POINTS).astype(np.int64))
        curve = survival_curve(lifetimes, times, confidence)
        points += [
            {**name.keys, "time": time * interval, **with_ends("survival", *ends)}
            for time, *ends in zip(times, *curve, strict=True)
        ]
    return {"survival": rows, "survival_curve": points}
