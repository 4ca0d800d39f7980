"""Gather what control achieved, by all forecasters and by alarms at random."""

from burstcast.control.scores import SCORES
from burstcast_workflow.harness.job import run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_json
from burstcast_workflow.harness.tables import write_rows
from burstcast_workflow.jobs.gather import gathered

COLUMNS = (
    "exceedance_uncontrolled",
    "exceedance_controlled",
    "reduction",
    "alarms",
    "false_alarms",
    "missed_events",
    "unsuppressed_events",
    "control_fraction",
)


def control_table(*, counts: list[str], table: str, settings: Settings) -> None:
    """Write one row for each forecaster and prediction time."""
    rows = []
    for record, path in gathered(settings["rows"], counts):
        found = read_json(path)
        del found["provenance"]
        # the rest of the outcome follows the columns that everybody looks at
        others = sorted(set(found) - set(COLUMNS) - set(SCORES))
        names = [*COLUMNS, "exceedance_free", "alarm_rate", *others]
        rows.append({**record["keys"], **{name: found[name] for name in names}})
    write_rows(table, rows)


if __name__ == "__main__":
    run_job(snakemake, control_table)  # noqa: F821 - Snakemake puts it there
