"""Forecasts of a job's case: the sets of their starting points, their windows."""

from burstcast import durations
from burstcast.arrays import FloatArray
from burstcast.files.netcdf import read_rows
from burstcast.forecast.forecast_files import point_variables, schedule_variables
from burstcast.forecast.horizon import HorizonSearch
from burstcast.forecast.observed_points import observed_points
from burstcast.forecast.windows import window_boundaries
from burstcast_workflow.harness.settings import CLASSIFICATION, Settings, concerning
from burstcast_workflow.harness.storage import read_json, write_netcdf
from burstcast_workflow.jobs.data import (
    check_kept_series,
    kept_series,
    known_rows,
    observed_rows,
    test_series,
)
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time


def boundaries_of(settings: Settings) -> tuple[int, ...]:
    """Boundaries of the windows of a forecast, in steps."""
    resolution = settings["classification.resolution_lt"]
    longest = settings["classification.longest_prediction_time_lt"]
    reach = longest + settings["classification.window_lt"]
    return window_boundaries(resolution, round(reach / resolution) - 1, lyapunov_time(settings))


def test_rows(settings: Settings, ensemble: str) -> range:
    """Test series: the kept series after the training series."""
    kept, first = kept_series(ensemble), settings["case.training.series"]
    series = test_series(settings, kept)
    check_kept_series(kept, {"training.series": first, "test_series": series})
    return range(first, first + series)


def horizon_search(settings: Settings, summary: str) -> HorizonSearch:
    """Search for prediction horizons, with the mean of all data from their summary."""
    steps, mean = lyapunov_time(settings), read_json(summary)["mean_observable"]
    return HorizonSearch(
        longest_lead_time_lt=settings["horizon.longest_lead_time_lt"],
        lead_time_step_lt=settings["horizon.lead_time_step_lt"],
        tolerance=settings["horizon.tolerance"] * (settings["case.event_threshold"] - mean),
        washout=durations.steps(settings["washout_lt"], steps),
        steps_per_lyapunov_time=steps,
    )


def write_point_set(
    path: str, settings: Settings, ensemble: str, rows: range, spacing: tuple[str, float]
) -> None:
    """Write starting points in kept series of an ensemble (see `write_points`)."""
    states = read_rows(ensemble, "state", rows.start, rows.stop)
    observed = observed_rows(settings, ensemble, rows.start, states)
    observable = read_rows(ensemble, "observable", rows.start, rows.stop)
    known = known_rows(ensemble, rows.start, rows.stop)
    write_points(path, settings, (states, observed, observable), spacing, known)


def write_points(
    path: str,
    settings: Settings,
    series: tuple[FloatArray, FloatArray, FloatArray],
    spacing: tuple[str, float],
    schedules: FloatArray | None = None,
) -> None:
    """Write starting points, observed washouts, and the true window summaries.

    ``series``: True states and observed ones, ``(series, time, dimension)`` each, and the true
    observable, ``(series, time)``. ``spacing``: Name of the setting with the distance of two
    points, and its value in Lyapunov times. ``schedules``: Parameters in force in each step,
    ``(series, time - 1, parameters)``; None: the parameters of the case.
    """
    system, steps = system_of(settings), lyapunov_time(settings)
    states, observed, observable = series
    (name, spacing_lt), boundaries = spacing, boundaries_of(settings)
    with concerning(CLASSIFICATION):
        found = observed_points(
            observed,
            observable,
            system.observable,
            spacing=durations.positive_steps(spacing_lt, steps, name),
            washout=durations.positive_steps(settings["washout_lt"], steps, "washout_lt"),
            boundaries=boundaries,
        )
    variables = point_variables(found, states, system.observable_name)
    if schedules is not None:
        variables |= schedule_variables(found, schedules, boundaries[-1])
    write_netcdf(path, variables, settings.provenance)
