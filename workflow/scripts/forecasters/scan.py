"""Validate a reservoir on the grid of the search, for strategies that share their sums."""

import pandas as pd

from burstcast.tuning.scan import scan as scan_points
from burstcast.tuning.scan_files import log_error_variables
from burstcast.tuning.strategies.registry import make_strategy
from burstcast_workflow.harness.job import Settings, concerning, job, write_netcdf, write_table
from burstcast_workflow.harness.settings import VALIDATION
from burstcast_workflow.jobs.networks import point_validator, search_space


@job
def scan_grid(
    *, ensemble: str, scheduled: list[str], scan: str, scan_errors: str, settings: Settings
) -> None:
    """Write the objective at every point, for every strategy and Tikhonov parameter."""
    validator = point_validator(settings, settings["reservoir"], ensemble, scheduled)
    strategies = [make_strategy(name) for name in settings["strategies"].split("+")]
    with concerning(VALIDATION):
        found = scan_points(validator, search_space(settings), strategies, settings["search.grid"])
    write_table(scan, pd.DataFrame([one.record() for one in found]))
    write_netcdf(scan_errors, log_error_variables(found), settings.provenance)
