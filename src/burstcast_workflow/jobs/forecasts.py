"""Forecasts of a job's case: the sets of their starting points, their windows."""

from collections.abc import Mapping

from burstcast import durations
from burstcast.files.netcdf import read_rows
from burstcast.forecast.forecast_files import point_variables
from burstcast.forecast.observed_points import observed_points
from burstcast.forecast.windows import window_boundaries
from burstcast_workflow.harness.settings import CLASSIFICATION, Settings, concerning
from burstcast_workflow.harness.storage import write_netcdf
from burstcast_workflow.jobs.data import observed_rows
from burstcast_workflow.jobs.systems import system_of


def windows_of(settings: Settings) -> tuple[float, int]:
    """Length of a window in Lyapunov times, and how many there are."""
    resolution = settings["classification.resolution_lt"]
    longest = settings["classification.longest_prediction_time_lt"]
    reach = longest + settings["classification.window_lt"]
    return resolution, round(reach / resolution) - 1


def write_point_set(
    path: str,
    settings: Settings,
    ensemble: str,
    rows: range,
    spacing: str,
    spacing_lt: float,
    steps_per_lyapunov_time: int,
    provenance: Mapping[str, str],
) -> None:
    """Write starting points, observed washouts, and the true window summaries.

    Parameters
    ----------
    path
        The file.
    settings
        With ``SYSTEM OBSERVED WINDOWS washout_lt`` of the rules.
    ensemble
        Path of the ensemble.
    rows
        Kept series that the points lie in.
    spacing, spacing_lt
        Setting of the distance of two points, and its value in Lyapunov times.
    steps_per_lyapunov_time
        Steps of a forecast in a Lyapunov time.
    provenance
        Of the job.

    Raises
    ------
    ValueError
        If the series are too short for a single point.
    """
    system, steps = system_of(settings), steps_per_lyapunov_time
    states = read_rows(ensemble, "state", rows.start, rows.stop)
    resolution_lt, count = windows_of(settings)
    with concerning(CLASSIFICATION):
        found = observed_points(
            observed_rows(settings, ensemble, rows.start, states),
            read_rows(ensemble, "observable", rows.start, rows.stop),
            system.observable,
            spacing=durations.positive_steps(spacing_lt, steps, spacing),
            washout=durations.positive_steps(settings["washout_lt"], steps, "washout_lt"),
            boundaries=window_boundaries(resolution_lt, count, steps),
        )
    write_netcdf(path, point_variables(found, states, system.observable_name), provenance)
