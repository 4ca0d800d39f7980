"""Gather the summaries of a case into its row of the table of the dataset."""

from collections.abc import Mapping
from typing import Any

from burstcast import durations
from burstcast.tables.cells import with_ends
from burstcast.tables.makers.registry import Declaration, Rows

TABLES = Declaration(
    inputs={"summary": "", "events_summary": "", "exponents": ""},
    settings="case.ensemble.time_step case.ensemble.sampling_stride case.lyapunov.time_unit "
    "case.lyapunov.published_exponent",
)

ENDS = ("mean", "low", "high")
OF_EVENTS = ("events_per_series", "event_share", "training_event_share")
OF_SERIES = ("series_generated", "series_kept", "laminarised_fraction", "mean_observable")


def make(
    *,
    summary: Mapping[str, Any],
    events_summary: Mapping[str, Any],
    exponents: Mapping[str, Any],
    time_step: float,
    sampling_stride: int,
    time_unit: str,
    published_exponent: float | None,
) -> dict[str, Rows]:
    """One row."""
    leading, growth = exponents["leading"], exponents.get("leading_by_growth", {})
    known = durations.known_exponent(time_unit, published_exponent)
    steps = durations.steps_per_lyapunov_time(
        leading["mean"] if known is None else known, float(time_step * sampling_stride)
    )
    row = {
        **{name: summary[name] for name in OF_SERIES},
        **{name: events_summary[name] for name in OF_EVENTS},
        **with_ends("lyapunov_exponent", *map(leading.get, ENDS)),
        **with_ends("lyapunov_exponent_by_growth", *map(growth.get, ENDS)),
        "lyapunov_exponent_paper": published_exponent,
        "steps_per_lyapunov_time": steps,
    }
    return {"dataset": [row]}
