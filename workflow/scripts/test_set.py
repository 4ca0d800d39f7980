"""Lay out the starting points of the test set: their washouts, and what truly follows."""

from typing import Any

import numpy as np

from burstcast import durations
from burstcast.dataset import component_scales, observed_series
from burstcast.forecast.starting_points import segments, starting_points
from burstcast.forecast.windows import summarise, window_boundaries
from burstcast.systems.registry import make_system
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.series_fit import check_classification, check_kept_series
from burstcast_workflow.storage import Variable, read_netcdf, read_rows, write_netcdf
from burstcast_workflow.time_unit import read_steps_per_lyapunov_time


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write starting points, observed washouts, and the true window summaries."""
    system = make_system(settings["system"], settings["parameters"])
    lyapunov_time = read_steps_per_lyapunov_time(settings, inputs.lyapunov)
    training = settings["training"]
    first, last = training["series"], training["series"] + settings["test_series"]
    check_kept_series(
        read_netcdf(inputs.ensemble, "series")["series"].size,
        {"training.series": training["series"], "test_series": settings["test_series"]},
    )
    scales = component_scales(read_rows(inputs.ensemble, "state", 0, training["series"]))
    states = read_rows(inputs.ensemble, "state", first, last)
    windows = settings["windows"]
    check_classification(
        states.shape[1],
        lyapunov_time,
        settings["washout_lt"],
        settings["start_spacing_lt"],
        windows["resolution_lt"],
        (windows["count"] + 1) * windows["resolution_lt"],
    )
    observed = observed_series(
        states,
        first,
        training["noise"],
        scales,
        settings["random_seed"],
        settings["case"],
    )
    washout = durations.steps(settings["washout_lt"], lyapunov_time)
    boundaries = window_boundaries(windows["resolution_lt"], windows["count"], lyapunov_time)
    points = starting_points(
        len(states),
        states.shape[1],
        durations.steps(settings["start_spacing_lt"], lyapunov_time),
        washout,
        boundaries[-1],
    )
    washouts = segments(observed, points, washout - 1, 0)
    truth = system.observable(segments(states, points, 0, boundaries[-1])[:, 1:].transpose(2, 1, 0))
    summaries = summarise(truth, boundaries)
    write_netcdf(
        outputs.test_set,
        {
            "series": Variable(("point",), points.series, "1", "row among the test series"),
            "step": Variable(("point",), points.step, "1", "step of the starting point"),
            "washout": Variable(
                ("point", "washout_step", "component"),
                washouts,
                "1",
                "observed states up to the starting point",
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
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
