"""Train a network on all training series with the hyperparameters that the search found."""

from burstcast import durations
from burstcast.esn import training
from burstcast.esn.dynamics import Dynamics
from burstcast.esn.network import EchoStateNetwork
from burstcast.forecasters.esn import NetworkForecaster
from burstcast_workflow.harness.job import Provenance, run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_json
from burstcast_workflow.jobs.forecasters import write_forecaster
from burstcast_workflow.jobs.time_unit import lyapunov_time
from burstcast_workflow.jobs.training import reservoir_seed, training_series


def train(
    *,
    ensemble: str,
    time_unit: str | list[str],
    hyperparameters: str,
    forecaster: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write the trained network."""
    series = training_series(settings, ensemble)
    chosen = read_json(hyperparameters)
    seed = reservoir_seed(settings, settings["forecaster"])
    dynamics = Dynamics(
        seed.reservoir(series.observed.shape[2]),
        chosen["spectral_radius"],
        chosen["input_scaling"],
        settings["forecasters.esn.backend"],
    )
    readout = training.train(
        dynamics,
        series,
        washout=durations.steps(settings["washout_lt"], lyapunov_time(settings, time_unit)),
        tikhonov=chosen["tikhonov"],
    )
    network = EchoStateNetwork(dynamics, readout, series.input_range)
    write_forecaster(forecaster, NetworkForecaster(network, seed, None), provenance)


if __name__ == "__main__":
    run_job(snakemake, train)  # noqa: F821 - Snakemake puts it there
