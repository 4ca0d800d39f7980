"""Train a network on all training series with the hyperparameters that the search found."""

from burstcast_workflow.harness.job import job, read_json
from burstcast_workflow.jobs.forecasters import write_forecaster
from burstcast_workflow.jobs.networks import Networks
from burstcast_workflow.jobs.trained_networks import trained_networks


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
    chosen = read_json(hyperparameters)
    (network,) = trained_networks(settings, ensemble, scheduled, [chosen])
    write_forecaster(forecaster, network, settings.provenance)
