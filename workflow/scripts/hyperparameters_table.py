"""Gather the hyperparameters of all networks."""

from typing import Any

from burstcast_workflow.gather import NETWORK, gathered
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.storage import read_json
from burstcast_workflow.table_files import keyed_table, write_table


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write one row for each network."""
    names = ("spectral_radius", "input_scaling", "tikhonov", "objective", "solver")
    rows = []
    for keys, path in gathered(settings["networks"], inputs.hyperparameters, NETWORK):
        record = read_json(path)
        rows.append({**keys, **{name: record[name] for name in names}})
    write_table(outputs.table, keyed_table(rows))


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
