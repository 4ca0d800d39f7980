"""Actuate the flow of a case at random, as often as a forecaster did."""

from burstcast.control.monitors.random import RandomMonitor, random_draws
from burstcast.control.strategies.prediction_triggered import PredictionTriggered
from burstcast_workflow.harness.job import Provenance, run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_json
from burstcast_workflow.identifiers import parsed
from burstcast_workflow.jobs.control import (
    control_experiment,
    control_noise,
    control_strategy,
    write_control,
)


def control_random(
    *,
    ensemble: str,
    summary: str,
    time_unit: str | list[str],
    rate: str,
    counts: str,
    histograms: str,
    flows: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write what control achieved."""
    experiment = control_experiment(settings, ensemble, summary, time_unit)
    strategy = control_strategy(settings)
    assert isinstance(strategy, PredictionTriggered)
    timing = strategy.timing(experiment.schedule)
    draws = random_draws(
        experiment.series,
        timing.most_forecasts,
        experiment.root_seed,
        experiment.case,
        parsed(settings["forecaster"]).seed or 0,
    )
    alarm_rate = read_json(rate)["alarm_rate"] or 0.0
    followed = strategy.follow(
        experiment,
        RandomMonitor(alarm_rate, draws),
        noise=control_noise(settings, ensemble, experiment, timing),
    )
    files = counts, histograms, flows
    write_control(files, strategy, experiment, followed, settings, provenance)


if __name__ == "__main__":
    run_job(snakemake, control_random)  # noqa: F821 - Snakemake puts it there
