"""Lay out the starting points of the evaluation set: their washouts, and what truly follows."""

import numpy as np

from burstcast import durations
from burstcast.forecast.starting_points import segments, starting_points
from burstcast.forecast.windows import summarise, window_boundaries
from burstcast_workflow.harness.job import Provenance, run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import Variable, read_rows, write_netcdf
from burstcast_workflow.jobs.data import kept_series, observed_rows
from burstcast_workflow.jobs.length_checks import check_classification, check_kept_series
from burstcast_workflow.jobs.systems import system_of
from burstcast_workflow.jobs.time_unit import lyapunov_time
from burstcast_workflow.jobs.windows import windows_of


def evaluation_set_of_case(
    *,
    ensemble: str,
    time_unit: str | list[str],
    evaluation_set: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write starting points, observed washouts, and the true window summaries."""
    system = system_of(settings)
    steps = lyapunov_time(settings, time_unit)
    first, series = settings["case.training.series"], settings["case.test_series"]
    check_kept_series(kept_series(ensemble), {"training.series": first, "test_series": series})
    states = read_rows(ensemble, "state", first, first + series)
    resolution_lt, count = windows_of(settings)
    check_classification(
        states.shape[1],
        steps,
        settings["washout_lt"],
        settings["classification.start_spacing_lt"],
        resolution_lt,
        (count + 1) * resolution_lt,
    )
    observed = observed_rows(settings, ensemble, first, states)
    washout = durations.steps(settings["washout_lt"], steps)
    boundaries = window_boundaries(resolution_lt, count, steps)
    points = starting_points(
        len(states),
        states.shape[1],
        durations.steps(settings["classification.start_spacing_lt"], steps),
        washout,
        boundaries[-1],
    )
    washouts = segments(observed, points, washout - 1, 0)
    truth = system.observable(segments(states, points, 0, boundaries[-1])[:, 1:].transpose(2, 1, 0))
    summaries = summarise(truth, boundaries)
    write_netcdf(
        evaluation_set,
        {
            "series": Variable(("point",), points.series, "1", "row among the test series"),
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
            "washout_maximum": Variable(
                ("point",),
                np.max(system.observable(washouts.transpose(2, 0, 1)), axis=1),
                "1",
                f"largest observed {system.observable_name} of the washout",
            ),
            "first": Variable(
                ("point", "window"),
                summaries.first,
                "1",
                f"true {system.observable_name} at the first step of each window",
            ),
            "largest": Variable(
                ("point", "window"),
                summaries.largest,
                "1",
                f"largest true {system.observable_name} in each window",
            ),
        },
        provenance,
    )


if __name__ == "__main__":
    run_job(snakemake, evaluation_set_of_case)  # noqa: F821 - Snakemake puts it there
