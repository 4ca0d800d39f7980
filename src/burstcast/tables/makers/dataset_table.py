"""Gather the summaries of a case into its row of the table of the dataset."""

from collections.abc import Mapping
from typing import Any

from burstcast.base import durations
from burstcast.base.declared import at, declaring, read
from burstcast.tables.cells import with_ends
from burstcast.tables.makers.registry import Rows

ENDS = ("mean", "low", "high")
OF_EVENTS = ("events_per_series", "event_share", "training_event_share")
OF_SERIES = ("series_generated", "series_kept", "laminarised_fraction", "mean_observable")


@declaring
def make(
    *,
    summary: Mapping[str, Any] = read("case/dataset.json"),
    events_summary: Mapping[str, Any] = read("case/events.json"),
    exponents: Mapping[str, Any] = read("source/lyapunov.json"),
    time_step: float = at("case.ensemble.time_step"),
    sampling_stride: int = at("case.ensemble.sampling_stride"),
    time_unit: str = at("case.lyapunov.time_unit"),
    given_exponent: float | None = at("case.lyapunov.given_exponent"),
) -> dict[str, Rows]:
    """One row."""
    leading, growth = exponents["leading"], exponents.get("leading_by_growth", {})
    exponent = durations.known_exponent(time_unit, given_exponent)
    steps = durations.steps_per_lyapunov_time(
        leading["mean"] if exponent is None else exponent, float(time_step * sampling_stride)
    )
    row = {
        **{name: summary[name] for name in OF_SERIES},
        **{name: events_summary[name] for name in OF_EVENTS},
        **with_ends("lyapunov_exponent", *map(leading.get, ENDS)),
        **with_ends("lyapunov_exponent_by_growth", *map(growth.get, ENDS)),
        "lyapunov_exponent_given": given_exponent,
        "steps_per_lyapunov_time": steps,
    }
    return {"dataset": [row]}
