"""Forecasts as files: the sets of their starting points, their windows, prediction horizons."""

from collections.abc import Mapping

from burstcast import durations
from burstcast.data.starting_points import segments
from burstcast.files.netcdf import Variable, read_rows
from burstcast.files.units import COMPONENT, NUMBER, OBSERVABLE
from burstcast.forecast.observed_points import observed_points
from burstcast.forecast.windows import WindowForecasts, window_boundaries
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


def write_forecasts(
    path: str, forecasts: WindowForecasts, name: str, provenance: Mapping[str, str]
) -> None:
    """Write forecasts of the observable called ``name``, and those of an ensemble's members."""
    points, members = ("point", "window"), ("point", "member", "window")
    first = f"forecast {name} at the first step of each window"
    largest = f"largest forecast {name} in each window"
    lost = "whether the forecast has diverged"
    variables = {
        "first": Variable(points, forecasts.first, OBSERVABLE, first),
        "largest": Variable(points, forecasts.largest, OBSERVABLE, largest),
        "diverged": Variable(("point",), forecasts.diverged, NUMBER, lost),
    }
    if forecasts.member_first.size:
        for name, meaning in (("member_first", first), ("member_largest", largest)):
            values = getattr(forecasts, name)
            variables[name] = Variable(members, values, OBSERVABLE, f"{meaning}, by each member")
    write_netcdf(path, variables, provenance)


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
    points, summaries = found.points, found.truth
    name = system.observable_name
    write_netcdf(
        path,
        {
            "series": Variable(
                ("point",), points.series, NUMBER, "row among the series of this set"
            ),
            "step": Variable(("point",), points.step, NUMBER, "step of the starting point"),
            "washout": Variable(
                ("point", "washout_step", "component"),
                found.washouts,
                COMPONENT,
                "observed states up to the starting point",
            ),
            "true_state": Variable(
                ("point", "component"),
                segments(states, points, 0, 0)[:, 0],
                COMPONENT,
                "true states at the starting points, for forecasters that see them",
            ),
            "observable_now": Variable(
                ("point",), found.seen[:, -1], OBSERVABLE, f"observed {name} at the starting point"
            ),
            "washout_maximum": Variable(
                ("point",),
                found.seen.max(axis=1),
                OBSERVABLE,
                f"largest observed {name} of the washout",
            ),
            "first": Variable(
                ("point", "window"),
                summaries.first,
                OBSERVABLE,
                f"true {name} at the first step of each window",
            ),
            "largest": Variable(
                ("point", "window"),
                summaries.largest,
                OBSERVABLE,
                f"largest true {name} in each window",
            ),
        },
        provenance,
    )
