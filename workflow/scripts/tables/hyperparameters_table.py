"""Gather the hyperparameters of all networks."""

from burstcast_workflow.harness.job import job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_json
from burstcast_workflow.jobs.gather import gathered
from burstcast_workflow.jobs.tables import write_tables

NAMES = ("spectral_radius", "input_scaling", "tikhonov", "objective", "solver")


@job
def hyperparameters_table(
    *, hyperparameters: list[str], tables: list[str], settings: Settings
) -> None:
    """Write one row for each network."""
    rows = []
    for keys, origin in gathered(settings, hyperparameters):
        chosen = read_json(origin.path)
        rows.append({**keys, **{name: chosen[name] for name in NAMES}})
    write_tables(tables, settings, hyperparameters=rows)
