"""Train a network on all training series with the hyperparameters that the search found."""

from burstcast.esn.dynamics import Dynamics
from burstcast.tuning.scan import leak_rate_of
from burstcast_workflow.harness.job import job, read_json
from burstcast_workflow.jobs.forecasters import write_forecaster
from burstcast_workflow.jobs.networks import Networks


@job
def train(
    *,
    ensemble: str,
    scheduled: list[str],
    hyperparameters: str,
    forecaster: str,
    settings: Networks,
) -> None:
    """Write the trained network."""
    chosen, seed = read_json(hyperparameters), settings.reservoir_seed(settings.forecaster)
    series = settings.learnt(ensemble, scheduled)
    unfitted = settings.unfitted(settings.forecaster)
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
        washout=settings.washout,
        tikhonov=chosen["tikhonov"],
        **settings.knowledge(scheduled),
    )
    write_forecaster(forecaster, network, settings.provenance)
