"""Gather the hyperparameters of all networks."""

from burstcast_workflow.harness.job import run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_json
from burstcast_workflow.harness.tables import write_rows
from burstcast_workflow.jobs.gather import gathered

NAMES = ("spectral_radius", "input_scaling", "tikhonov", "objective", "solver")


def hyperparameters_table(*, hyperparameters: list[str], table: str, settings: Settings) -> None:
    """Write one row for each network."""
    rows = []
    for record, path in gathered(settings["rows"], hyperparameters):
        chosen = read_json(path)
        rows.append({**record["keys"], **{name: chosen[name] for name in NAMES}})
    write_rows(table, rows)


if __name__ == "__main__":
    run_job(snakemake, hyperparameters_table)  # noqa: F821 - Snakemake puts it there
