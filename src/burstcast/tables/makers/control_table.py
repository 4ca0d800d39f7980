"""Gather the outcomes of the paper's control by all forecasters and by random alarms."""

from collections.abc import Sequence
from dataclasses import fields

from burstcast.base.declared import declaring, gathered
from burstcast.control.records import RECORDS, FlowSample
from burstcast.control.windows import WindowCounts, totals
from burstcast.tables.makers.registry import Gathered, Rows

COUNTS = tuple(field.name for field in fields(WindowCounts))


@declaring
def make(
    *,
    flows: Sequence[Gathered] = gathered("control_runs/flows.nc", " ".join([*RECORDS, *COUNTS])),
) -> dict[str, Rows]:
    """One row for each forecaster and prediction time."""
    rows: Rows = []
    for one in flows:
        counts = WindowCounts(**{name: one.content[name] for name in COUNTS})
        rows.append(
            {
                **one.name.keys,
                "prediction_time_lt": one.plan["settings"]["prediction_time_lt"],
                **totals(FlowSample.of(one.content), counts, int(one.content["left_out"])),
            }
        )
    return {"control": rows}
