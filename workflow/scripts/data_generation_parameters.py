"""Make the paper's table of the parameters of the data, for all cases."""

from typing import Any

from burstcast.tables import data_parameters, side_by_side
from burstcast_workflow.gather import CASE, gathered
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.storage import read_json
from burstcast_workflow.table_files import write_table


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write one column of values for each case."""
    tables = {
        record["case"]: data_parameters(
            **record["parameters"], series_kept=read_json(path)["series_kept"]
        )
        for record, path in gathered(settings["cases"], inputs.datasets, CASE)
    }
    write_table(outputs.table, side_by_side(tables))


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
