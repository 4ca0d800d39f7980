"""Control the flow of a case by the alarms of a forecaster."""

from burstcast_workflow.harness.job import Provenance, run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.control import ControlSetting, write_outcome
from burstcast_workflow.jobs.forecasters import read_forecaster


def control(
    *,
    ensemble: str,
    summary: str,
    time_unit: str | list[str],
    forecaster: str,
    counts: str,
    histograms: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write what control achieved."""
    setting = ControlSetting.read(settings, ensemble, summary, time_unit)
    who = read_forecaster(forecaster, settings, time_unit)
    flows = setting.run(setting.forecast_monitor(who), noisy=not who.sees_truth)
    write_outcome(counts, histograms, setting.outcome(flows), provenance)


if __name__ == "__main__":
    run_job(snakemake, control)  # noqa: F821 - Snakemake puts it there
