"""Find the extreme events of the series that were not used for training."""

from typing import Any

import numpy as np

from burstcast import durations
from burstcast.dataset import component_scales, observed_series
from burstcast.forecast.starting_points import (
    SeriesPoints,
    crossing_points,
    horizon_events,
    segments,
)
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.series_fit import check_horizon, check_kept_series
from burstcast_workflow.storage import Variable, read_netcdf, read_rows, write_json, write_netcdf
from burstcast_workflow.time_unit import read_steps_per_lyapunov_time


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write the events, with what was observed and what was true before each of them."""
    lyapunov_time = read_steps_per_lyapunov_time(settings, inputs.lyapunov)
    training = settings["training"]
    kept = read_netcdf(inputs.ensemble, "series")["series"].size
    check_kept_series(kept, {"training.series": training["series"]})
    scales = component_scales(read_rows(inputs.ensemble, "state", 0, training["series"]))
    observable = read_netcdf(inputs.ensemble, "observable")["observable"]
    check_horizon(
        observable.shape[1], lyapunov_time, settings["washout_lt"], settings["longest_start_lt"]
    )
    if not settings["event_threshold"] > observable.mean():
        raise ValueError(
            f"event_threshold is {settings['event_threshold']}, but it must exceed the mean of the "
            f"observable over all data, {observable.mean():.4g}"
        )
    crossings = crossing_points(observable, settings["event_threshold"])
    before = (
        durations.steps(settings["longest_start_lt"], lyapunov_time)
        + durations.steps(settings["washout_lt"], lyapunov_time)
        - 1
    )
    events = horizon_events(crossings, training["series"], before, settings["events"])
    first = training["series"]
    last = int(events.series.max()) + 1 if len(events) else first
    observed = observed_series(
        read_rows(inputs.ensemble, "state", first, last),
        first,
        training["noise"],
        scales,
        settings["random_seed"],
        settings["case"],
    )
    in_part = SeriesPoints(events.series - first, events.step)
    write_netcdf(
        outputs.events,
        {
            "series": Variable(("event",), events.series, "1", "row among the kept series"),
            "step": Variable(("event",), events.step, "1", "step at which the event begins"),
            "observed": Variable(
                ("event", "step_before", "component"),
                segments(observed, in_part, before, 0),
                "1",
                "observed states up to the event",
            ),
            "truth": Variable(
                ("event", "step_before"),
                segments(observable, events, before, 0),
                "1",
                "true observable up to the event",
            ),
        },
        provenance,
    )
    write_json(
        outputs.summary,
        {
            "events_per_series": len(crossings) / len(observable),
            "usable_events": len(events),
            "largest_observable": float(np.max(observable)),
            "provenance": provenance,
        },
    )


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
