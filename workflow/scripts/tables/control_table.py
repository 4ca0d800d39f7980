"""Gather what control achieved, by all forecasters and by alarms at random."""

from burstcast_workflow.harness.job import job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_json
from burstcast_workflow.jobs.gather import gathered
from burstcast_workflow.jobs.percentiles import write_percentiles
from burstcast_workflow.jobs.tables import write_tables


@job
def control_table(*, counts: list[str], tables: list[str], settings: Settings) -> None:
    """Write one row for each forecaster and prediction time."""
    rows = []
    for record, path in gathered(settings["rows"], counts):
        found = read_json(path)
        del found["provenance"]
        rows.append({**record["keys"], **found})
    write_tables(tables, settings, control=rows)
    write_percentiles(tables, settings)
