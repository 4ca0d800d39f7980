"""Measure how long before each extreme event a network predicts it."""

from typing import Any

from burstcast import durations
from burstcast.forecast.horizon import HorizonSearch, prediction_horizons
from burstcast.systems.registry import make_system
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.network_files import read_forecaster
from burstcast_workflow.storage import Variable, read_json, read_netcdf, write_netcdf
from burstcast_workflow.time_unit import read_steps_per_lyapunov_time


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write the prediction horizon of every event."""
    system = make_system(settings["system"], settings["parameters"])
    lyapunov_time = read_steps_per_lyapunov_time(settings, inputs.lyapunov)
    events = read_netcdf(inputs.events)
    mean = read_json(inputs.summary)["mean_observable"]
    horizon = settings["horizon"]
    search = HorizonSearch(
        longest_lead_time_lt=horizon["longest_start_lt"],
        lead_time_step_lt=horizon["start_step_lt"],
        tolerance=horizon["tolerance"] * (settings["event_threshold"] - mean),
        washout=durations.steps(settings["washout_lt"], lyapunov_time),
        steps_per_lyapunov_time=lyapunov_time,
    )
    horizons = prediction_horizons(
        read_forecaster(inputs.network, settings["kernel"]),
        system.observable,
        events["observed"],
        events["truth"],
        search,
    )
    write_netcdf(
        outputs.horizon,
        {
            "series": Variable(("event",), events["series"], "1", "row among the kept series"),
            "step": Variable(("event",), events["step"], "1", "step at which the event begins"),
            "prediction_horizon_lt": Variable(
                ("event",), horizons, "1", "prediction horizon of the event in Lyapunov times"
            ),
        },
        provenance,
    )


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
