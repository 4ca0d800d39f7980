"""Train a network on all training series with the hyperparameters that the search found."""

from typing import Any

from burstcast.base.names import parsed
from burstcast.forecasters._limits import TrainingLimits
from burstcast.forecasters.esn import NetworkForecaster
from burstcast.forecasters.registry import make_kind
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.scan import leak_rate_of
from burstcast_workflow.harness.job import JobSettings, at, job, read_json, tell
from burstcast_workflow.jobs.forecasters import write_forecaster
from burstcast_workflow.jobs.networks import Networks


class Training(JobSettings):
    """A network that is trained."""

    networks: Networks
    options: dict[str, Any] = at("forecaster.options")

    @property
    def unfitted(self) -> NetworkForecaster:
        """The network with its options alone."""
        options = {**self.options, "divergence_bound": None}
        kind = make_kind(parsed(self.forecaster).kind, options)
        assert isinstance(kind, NetworkForecaster)
        return kind


@job
def train(
    *,
    ensemble: str,
    scheduled: list[str],
    hyperparameters: str,
    forecaster: str,
    settings: Training,
) -> None:
    """Write the trained network."""
    chosen, seed = read_json(hyperparameters), settings.networks.reservoir_seed(settings.forecaster)
    series = settings.networks.learnt(ensemble, scheduled)
    unfitted, washout = settings.unfitted, settings.networks.washout
    dynamics = Dynamics(
        seed.reservoir(series.dimension),
        chosen["spectral_radius"],
        chosen["input_scaling"],
        unfitted.backend,
        leak_rate_of(chosen),
        unfitted.readout,
    )
    network = unfitted.trained(
        dynamics,
        seed,
        series,
        washout=washout.steps,
        tikhonov=chosen["tikhonov"],
        steps_per_lyapunov_time=washout.clock.lyapunov_time,
    )
    for text in network.weaknesses():
        tell(text)
    limits = TrainingLimits.of(series.observed, series.dimension)
    write_forecaster(forecaster, network, settings.provenance, limits)
