"""Train a network on all training series with the hyperparameters that the search found."""

from typing import Any

from burstcast import durations
from burstcast.esn.dynamics import Dynamics
from burstcast.esn.network import EchoStateNetwork
from burstcast.esn.training import train
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.network_files import backend_of, reservoir, training_series, write_network
from burstcast_workflow.storage import read_json
from burstcast_workflow.time_unit import read_steps_per_lyapunov_time


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write the trained network."""
    training = training_series(settings, inputs.ensemble)
    chosen = read_json(inputs.hyperparameters)
    dynamics = Dynamics(
        reservoir(settings, training.observed.shape[2]),
        chosen["spectral_radius"],
        chosen["input_scaling"],
        backend_of(settings["kernel"]),
    )
    readout = train(
        dynamics,
        training,
        washout=durations.steps(
            settings["washout_lt"], read_steps_per_lyapunov_time(settings, inputs.lyapunov)
        ),
        tikhonov=chosen["tikhonov"],
    )
    network = EchoStateNetwork(dynamics, readout, training.input_range)
    write_network(outputs.network, network, settings, provenance)


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
