"""Gather the outcomes of control by all forecasters and by random alarms."""

from collections.abc import Sequence

from burstcast.tables.makers.registry import Declaration, Gathered, Rows

TABLES = Declaration(gathered={"counts": ""})


def make(*, counts: Sequence[Gathered]) -> dict[str, Rows]:
    """One row for each forecaster and prediction time."""
    rows = [
        {
            **one.name.keys,
            "prediction_time_lt": one.plan["settings"]["prediction_time_lt"],
            **one.content,
        }
        for one in counts
    ]
    return {"control": rows}
