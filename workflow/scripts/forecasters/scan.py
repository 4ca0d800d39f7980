"""Validate a reservoir on the grid of the search, for strategies that share their sums."""

from burstcast.networks.scan import scan as scan_points
from burstcast.networks.scan_files import log_error_variables
from burstcast.networks.validation_strategies.registry import make_strategy
from burstcast_workflow.harness.job import (
    JobSettings,
    at,
    concerning,
    job,
    write_netcdf,
    write_table,
)
from burstcast_workflow.jobs.cases import Washout
from burstcast_workflow.jobs.networks import Search


class Scan(JobSettings):
    """The search, on a grid."""

    search: Search
    grid: int = at("search.grid")


@job
def scan_grid(
    *, ensemble: str, scheduled: list[str], scan: str, scan_errors: str, settings: Scan
) -> None:
    """Write the objective at every point, for every strategy and Tikhonov parameter."""
    import pandas as pd  # jobs from the cache start without it

    validator = settings.search.point_validator(settings.reservoir, ensemble, scheduled)
    strategies = [make_strategy(name) for name in settings.strategies.split("+")]
    with concerning(Search.intervals, Search.interval_lt, Washout.lt):
        evaluations = scan_points(validator, settings.search.space, strategies, settings.grid)
    write_table(scan, pd.DataFrame([evaluation.record() for evaluation in evaluations]))
    write_netcdf(scan_errors, log_error_variables(evaluations), settings.provenance)
