"""Control the flow of a case by a strategy that asks no forecaster."""

from burstcast_workflow.harness.job import Provenance, run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.control import (
    control_experiment,
    control_noise,
    control_strategy,
    write_control,
)


def control_without_forecast(
    *,
    ensemble: str,
    summary: str,
    time_unit: str | list[str],
    counts: str,
    histograms: str,
    flows: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write what control without a forecast achieved."""
    experiment = control_experiment(settings, ensemble, summary, time_unit)
    strategy = control_strategy(settings)
    noise = control_noise(settings, ensemble, experiment, strategy.timing(experiment.schedule))
    followed = strategy.follow(experiment, strategy.monitor(experiment, []), noise=noise)
    files = counts, histograms, flows
    write_control(files, strategy, experiment, followed, settings, provenance)


if __name__ == "__main__":
    run_job(snakemake, control_without_forecast)  # noqa: F821 - Snakemake puts it there
