"""Gather the summaries of a case into its row of the table of the dataset."""

from collections.abc import Mapping
from typing import Any

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
    steps_per_lyapunov_time: int = read("case/time_unit.json:steps_per_lyapunov_time"),
    given_exponent: float | None = at("case.lyapunov.given_exponent"),
) -> dict[str, Rows]:
    """One row."""
    leading, growth = exponents["leading"], exponents.get("leading_by_growth", {})
    row = {
        **{name: summary[name] for name in OF_SERIES},
        **{name: events_summary[name] for name in OF_EVENTS},
        **with_ends("lyapunov_exponent", *map(leading.get, ENDS)),
        **with_ends("lyapunov_exponent_by_growth", *map(growth.get, ENDS)),
        "lyapunov_exponent_given": given_exponent,
        "steps_per_lyapunov_time": steps_per_lyapunov_time,
    }
    return {"dataset": [row]}
