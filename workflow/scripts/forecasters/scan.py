"""Validate a reservoir on the grid of the search, for strategies that share their sums."""

import pandas as pd

from burstcast.tuning.strategies.registry import make_strategy
from burstcast_workflow.harness.job import Provenance, job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.tables import write_table
from burstcast_workflow.jobs.searches import (
    point_validator,
    search_space,
    trace_rows,
    write_log_errors,
)


@job
def scan_grid(
    *,
    ensemble: str,
    time_unit: str | list[str],
    scan: str,
    scan_errors: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write the objective at every point, for every strategy and Tikhonov parameter."""
    validator = point_validator(settings, settings["reservoir"], ensemble, time_unit)
    strategies = [make_strategy(name) for name in settings["strategies"].split("+")]
    rows, validations = [], []
    for number, point in enumerate(search_space(settings).grid(settings["search.grid"])):
        of_point = validator(point, strategies)
        rows += trace_rows(number, "grid", point, of_point)
        validations += of_point
    write_table(scan, pd.DataFrame(rows))
    write_log_errors(scan_errors, validations, provenance)
