"""Make the paper's table of the hyperparameters of the networks."""

from typing import Any

from burstcast.tables import network_parameters, side_by_side
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.table_files import write_table


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write one column of values, or one for each case where the noise differs."""
    tables = {
        case: network_parameters(**settings["network"], noise=noise)
        for case, noise in settings["noise"]
    }
    write_table(outputs.table, side_by_side(tables))


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
