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
    *, flows: Sequence[Gathered] = gathered("control_runs/flows.nc", " ".join([*RECORDS, *COUNTS]))
) -> dict[str, Rows]:
    """One row for each forecaster and prediction time."""
    rows: Rows = []
    for run in flows:
        counts = WindowCounts(**{name: run.content[name] for name in COUNTS})
        rows.append(
            {
                **run.name.keys,
                "prediction_time_lt": run.plan["settings"]["prediction_time_lt"],
                **totals(FlowSample.of(run.content), counts, int(run.content["left_out"])),
            }
        )
    return {"control": rows}
