"""Take percentiles over networks of a table with one row for each network."""

from typing import Any

from burstcast.tables import percentiles
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.table_files import read_table, write_table


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write the percentiles in long form."""
    table = read_table(inputs.table)
    write_table(outputs.table, percentiles(table, settings["keys"], settings["metrics"]))


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
