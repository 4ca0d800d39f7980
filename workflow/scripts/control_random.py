"""Actuate the flow of a case at random, as often as a network did."""

from typing import Any

from burstcast.control.monitors.random import RandomMonitor, random_draws
from burstcast_workflow.controls import ControlSetting, write_outcome
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.storage import read_json


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write what control achieved."""
    setting = ControlSetting.read(settings, inputs)
    alarm_rate = read_json(inputs.counts)["alarm_rate"] or 0.0
    draws = random_draws(
        setting.series,
        setting.timing.most_forecasts,
        settings["random_seed"],
        settings["case"],
        settings.get("seed", 0),
    )
    flows = setting.run(RandomMonitor(alarm_rate, draws), noisy=False)
    write_outcome(outputs, setting.count_outcome(flows), provenance)


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
