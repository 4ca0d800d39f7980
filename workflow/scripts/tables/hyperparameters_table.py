"""Gather the hyperparameters of all networks."""

from burstcast_workflow.harness.job import job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_json
from burstcast_workflow.jobs.gather import gathered
from burstcast_workflow.jobs.percentiles import write_percentiles
from burstcast_workflow.jobs.tables import write_tables

NAMES = ("spectral_radius", "input_scaling", "tikhonov", "objective", "solver")


@job
def hyperparameters_table(
    *, hyperparameters: list[str], tables: list[str], settings: Settings
) -> None:
    """Write one row for each network."""
    rows = []
    for record, path in gathered(settings["rows"], hyperparameters):
        chosen = read_json(path)
        rows.append({**record["keys"], **{name: chosen[name] for name in NAMES}})
    write_tables(tables, settings, hyperparameters=rows)
    write_percentiles(tables, settings)
