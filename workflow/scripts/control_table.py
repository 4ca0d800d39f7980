"""Gather what control achieved, by networks and by the forecasters to compare with."""

from typing import Any

from burstcast.control.scores import SCORES
from burstcast_workflow.gather import NETWORK, gathered
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.storage import read_json
from burstcast_workflow.table_files import keyed_table, write_table

RUN = ("rule", *NETWORK, "prediction_time_lt")
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


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write one row for each forecaster, network and prediction time."""
    rows = []
    for run, path in gathered(settings["runs"], inputs.counts, RUN):
        keys = {name: value for name, value in run.items() if name != "rule"}
        record = read_json(path)
        del record["provenance"]
        # the rest of the accounting follows the columns that everybody looks at
        others = sorted(set(record) - set(COLUMNS) - set(SCORES))
        names = [*COLUMNS, "exceedance_free", "alarm_rate", *others]
        rows.append({**keys, **{name: record[name] for name in names}})
    write_table(outputs.table, keyed_table(rows))


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
