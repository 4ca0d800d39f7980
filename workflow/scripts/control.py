"""Control the flow of a case by the alarms of one network."""

from typing import Any

from burstcast_workflow.controls import ControlSetting, write_outcome
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.network_files import read_forecaster


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write what control achieved."""
    setting = ControlSetting.read(settings, inputs)
    forecaster = read_forecaster(inputs.network, settings["kernel"])
    flows = setting.run(setting.forecast_monitor(forecaster), noisy=True)
    write_outcome(outputs, setting.count_outcome(flows), provenance)


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
