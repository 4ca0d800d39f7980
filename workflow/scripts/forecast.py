"""Forecast the test set with a network; keep only the window summaries."""

from typing import Any

from burstcast.forecast.windows import forecast_summaries, window_boundaries
from burstcast.systems.registry import make_system
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.network_files import read_forecaster
from burstcast_workflow.storage import Variable, read_netcdf, write_netcdf
from burstcast_workflow.time_unit import read_steps_per_lyapunov_time


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write the first and largest observable of every window of every forecast."""
    system = make_system(settings["system"], settings["parameters"])
    windows = settings["windows"]
    boundaries = window_boundaries(
        windows["resolution_lt"],
        windows["count"],
        read_steps_per_lyapunov_time(settings, inputs.lyapunov),
    )
    summaries, diverged = forecast_summaries(
        read_forecaster(inputs.network, settings["kernel"], settings["divergence_bound"]),
        system.observable,
        read_netcdf(inputs.test_set, "washout")["washout"],
        boundaries,
    )
    name = system.observable_name
    write_netcdf(
        outputs.forecast,
        {
            "first": Variable(
                ("point", "window"),
                summaries.first,
                "1",
                f"forecast {name} at the first step of each window",
            ),
            "largest": Variable(
                ("point", "window"), summaries.largest, "1", f"largest forecast {name} in a window"
            ),
            "diverged": Variable(("point",), diverged, "1", "whether the forecast has diverged"),
        },
        provenance,
    )


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
