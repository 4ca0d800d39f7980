"""Train a network on all training series with the hyperparameters that the search found."""

from typing import Any

from burstcast import durations
from burstcast_workflow.harness.job import Settings, job, read_json
from burstcast_workflow.jobs.forecasters import kind_of, write_forecaster
from burstcast_workflow.jobs.networks import (
    dynamics_at,
    knowledge,
    reservoir_seed,
    training_series,
)
from burstcast_workflow.jobs.time_unit import lyapunov_time


@job
def train(
    *,
    ensemble: str,
    scheduled: list[str],
    hyperparameters: str,
    forecaster: str,
    settings: Settings,
) -> None:
    """Write the trained network."""
    series = training_series(settings, ensemble, scheduled)
    networks: Any = kind_of(settings["forecaster"])
    chosen = read_json(hyperparameters)
    seed = reservoir_seed(settings, settings["forecaster"])
    network = networks.trained(
        dynamics_at(settings, seed, series.dimension, chosen),
        seed,
        series,
        washout=durations.steps(settings["washout_lt"], lyapunov_time(settings)),
        tikhonov=chosen["tikhonov"],
        divergence_bound=None,
        **knowledge(settings, scheduled),
    )
    write_forecaster(forecaster, network, settings.provenance)
