"""Train a network on all training series with the hyperparameters that the search found."""

from burstcast_workflow.harness.job import Provenance, job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import read_json
from burstcast_workflow.jobs.candidates import candidate
from burstcast_workflow.jobs.forecasters import write_forecaster
from burstcast_workflow.jobs.training import training_series


@job
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
    series, chosen = training_series(settings, ensemble), read_json(hyperparameters)
    write_forecaster(forecaster, candidate(settings, time_unit, series, chosen, None), provenance)
