"""Sets of starting points: what is observed up to each of them, and what truly follows."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from burstcast import durations
from burstcast.forecast.starting_points import segments, starting_points
from burstcast.forecast.windows import summarise, window_boundaries
from burstcast_workflow.harness.storage import Variable, read_rows, write_netcdf
from burstcast_workflow.jobs.data import observed_rows
from burstcast_workflow.jobs.length_checks import check_classification
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.windows import windows_of

Settings = Mapping[str, Any]


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
    check_classification(
        states.shape[1],
        steps,
        settings["washout_lt"],
        spacing_lt,
        resolution_lt,
        (count + 1) * resolution_lt,
        spacing,
    )
    observed = observed_rows(settings, ensemble, rows.start, states)
    washout = durations.steps(settings["washout_lt"], steps)
    boundaries = window_boundaries(resolution_lt, count, steps)
    points = starting_points(
        len(states),
        states.shape[1],
        durations.steps(spacing_lt, steps),
        washout,
        boundaries[-1],
    )
    washouts = segments(observed, points, washout - 1, 0)
    seen = system.observable(washouts.transpose(2, 0, 1))
    truth = system.observable(segments(states, points, 0, boundaries[-1])[:, 1:].transpose(2, 1, 0))
    summaries = summarise(truth, boundaries)
    name = system.observable_name
    write_netcdf(
        path,
        {
            "series": Variable(("point",), points.series, "1", "row among the series of this set"),
            "step": Variable(("point",), points.step, "1", "step of the starting point"),
            "washout": Variable(
                ("point", "washout_step", "component"),
                washouts,
                "1",
                "observed states up to the starting point",
            ),
            "true_state": Variable(
                ("point", "component"),
                segments(states, points, 0, 0)[:, 0],
                "1",
                "true states at the starting points, for forecasters that see them",
            ),
            "observable_now": Variable(
                ("point",), seen[:, -1], "1", f"observed {name} at the starting point"
            ),
            "washout_maximum": Variable(
                ("point",), np.max(seen, axis=1), "1", f"largest observed {name} of the washout"
            ),
            "first": Variable(
                ("point", "window"),
                summaries.first,
                "1",
                f"true {name} at the first step of each window",
            ),
            "largest": Variable(
                ("point", "window"), summaries.largest, "1", f"largest true {name} in each window"
            ),
        },
        provenance,
    )
