"""Control the flow of a case by a strategy that asks a forecaster."""

from burstcast_workflow.harness.job import Provenance, run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.control import (
    control_experiment,
    control_noise,
    control_strategy,
    write_control,
)
from burstcast_workflow.jobs.forecasters import read_forecaster


def control(
    *,
    ensemble: str,
    summary: str,
    time_unit: str | list[str],
    forecaster: str,
    counts: str,
    histograms: str,
    flows: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write what control by a forecaster achieved."""
    experiment = control_experiment(settings, ensemble, summary, time_unit)
    strategy, who = control_strategy(settings), read_forecaster(forecaster, settings, time_unit)
    noise = None
    if not who.sees_truth:
        noise = control_noise(settings, ensemble, experiment, strategy.timing(experiment.schedule))
    followed = strategy.follow(experiment, strategy.monitor(experiment, [who]), noise=noise)
    files = counts, histograms, flows
    write_control(files, strategy, experiment, followed, settings, provenance)


if __name__ == "__main__":
    run_job(snakemake, control)  # noqa: F821 - Snakemake puts it there
