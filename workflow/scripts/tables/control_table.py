"""Gather what control achieved, by all forecasters and by alarms at random."""

from burstcast_workflow.harness.job import job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_json
from burstcast_workflow.jobs.gather import gathered
from burstcast_workflow.jobs.tables import write_tables


@job
def control_table(*, counts: list[str], tables: list[str], settings: Settings) -> None:
    """Write one row for each forecaster and prediction time."""
    rows = []
    for keys, origin in gathered(settings, counts):
        plan, found = origin.settings["control.run"], read_json(origin.path)
        del found["provenance"]
        time = plan["settings"]["prediction_time_lt"]
        rows.append({**keys, "prediction_time_lt": time, **found})
    write_tables(tables, settings, control=rows)
