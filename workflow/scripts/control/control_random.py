"""Actuate the flow of a case at random, as often as a forecaster did."""

from burstcast.control.monitors.random import RandomMonitor, random_draws
from burstcast_workflow.harness.job import Provenance, run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_json
from burstcast_workflow.identifiers import parsed
from burstcast_workflow.jobs.control import ControlSetting, write_outcome


def control_random(
    *,
    ensemble: str,
    summary: str,
    time_unit: str | list[str],
    rate: str,
    counts: str,
    histograms: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write what control achieved."""
    setting = ControlSetting.read(settings, ensemble, summary, time_unit)
    draws = random_draws(
        setting.series,
        setting.timing.most_forecasts,
        settings["random_seed"],
        settings["case"],
        parsed(settings["forecaster"]).seed or 0,
    )
    alarm_rate = read_json(rate)["alarm_rate"] or 0.0
    flows = setting.run(RandomMonitor(alarm_rate, draws), noisy=False)
    write_outcome(counts, histograms, setting.outcome(flows), provenance)


if __name__ == "__main__":
    run_job(snakemake, control_random)  # noqa: F821 - Snakemake puts it there
