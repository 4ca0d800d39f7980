"""Control the flow of a case by a strategy that asks a committee."""

from burstcast.control.committee import committee_monitor
from burstcast_workflow.harness.job import Provenance, run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.jobs.control import (
    control_experiment,
    control_noise,
    control_strategy,
    write_control,
)
from burstcast_workflow.jobs.forecasters import read_forecaster


def control_committee(
    *,
    ensemble: str,
    summary: str,
    time_unit: str | list[str],
    forecasters: list[str],
    counts: str,
    histograms: str,
    flows: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write what control by a vote achieved."""
    experiment = control_experiment(settings, ensemble, summary, time_unit)
    strategy = control_strategy(settings)
    voters = [read_forecaster(path, settings, time_unit) for path in forecasters]
    noise = control_noise(settings, ensemble, experiment, strategy.timing(experiment.schedule))
    monitor = committee_monitor(strategy, experiment, voters)
    followed = strategy.follow(experiment, monitor, noise=noise)
    files = counts, histograms, flows
    write_control(files, strategy, experiment, followed, settings, provenance)


if __name__ == "__main__":
    run_job(snakemake, control_committee)  # noqa: F821 - Snakemake puts it there
