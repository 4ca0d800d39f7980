"""Control the flow of a case by a perfect forecaster: the equations, from the true state."""

from typing import Any

from burstcast.forecasters.equations import EquationsForecaster
from burstcast_workflow.controls import ControlSetting, write_outcome
from burstcast_workflow.job import Provenance, run_job


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write what control achieved."""
    setting = ControlSetting.read(settings, inputs)
    equations = EquationsForecaster(
        setting.system, settings["time_step"], settings["sampling_stride"]
    )
    flows = setting.run(setting.forecast_monitor(equations), noisy=False)
    write_outcome(outputs, setting.count_outcome(flows), provenance)


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
