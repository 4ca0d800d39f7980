"""Measure how long before each extreme event a network predicts it."""

from typing import Any

import numpy as np
import pandas as pd

from burstcast import durations
from burstcast.forecast.horizon import HorizonSearch, prediction_horizons
from burstcast.systems.registry import make_system
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.network_files import read_forecaster
from burstcast_workflow.storage import read_json, read_netcdf
from burstcast_workflow.table_files import write_table
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
    write_table(
        outputs.horizon,
        pd.DataFrame(
            {
                "event": np.arange(len(horizons)),
                "series": events["series"],
                "step": events["step"],
                "prediction_horizon_lt": horizons,
            }
        ),
    )


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
