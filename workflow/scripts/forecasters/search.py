"""Search on from the grid by Bayesian optimisation, and pick the best hyperparameters."""

import numpy as np
import pandas as pd

from burstcast.files.tables import read_table
from burstcast.forecasters._names import parsed
from burstcast.tuning import network_search
from burstcast.tuning.scan_files import read_evaluations
from burstcast.tuning.strategies.registry import make_strategy
from burstcast.tuning.uncertainty import objective_uncertainty
from burstcast_workflow.harness.job import Settings, job, write_json, write_table
from burstcast_workflow.jobs.networks import (
    point_validator,
    reservoir_seed,
    search_space,
    surrogate_settings,
)


@job
def search(
    *,
    ensemble: str,
    scheduled: list[str],
    scan: str,
    scan_errors: str,
    hyperparameters: str,
    trace: str,
    settings: Settings,
) -> None:
    """Write the whole trace of the search and its best point."""
    identifier = settings["forecaster"]
    validator = point_validator(settings, identifier, ensemble, scheduled)
    strategy = make_strategy(str(parsed(identifier).validation))
    reservoir = reservoir_seed(settings, identifier)
    found = network_search.search(
        validator,
        search_space(settings),
        strategy,
        read_evaluations(read_table(scan).to_dict("records"), scan_errors),
        settings["search.bayesian_points"],
        network_search.optimiser_seed(reservoir, settings["case"], strategy.name),
        surrogate_settings(settings),
    )
    uncertainty = objective_uncertainty(np.array([one.validation.log_errors for one in found]))
    table = pd.DataFrame([one.record() for one in found])
    write_table(trace, table.assign(**vars(uncertainty)))
    write_json(hyperparameters, network_search.best(found).record(), settings.provenance)
