"""Search on from the grid by Bayesian optimisation, and pick the best hyperparameters."""

from typing import Any

import numpy as np

from burstcast.base.files.tables import read_table
from burstcast.base.names import parsed
from burstcast.networks import network_search
from burstcast.networks.hyperparameters import SurrogateSettings
from burstcast.networks.scan_files import read_evaluations
from burstcast.networks.uncertainty import objective_uncertainty
from burstcast.networks.validation_strategies.registry import make_strategy
from burstcast_workflow.harness.job import JobSettings, at, job, write_json, write_table
from burstcast_workflow.jobs.networks import Search


class BayesianSearch(JobSettings):
    """The search, beyond the grid."""

    search: Search
    points: int = at("search.bayesian_points")
    surrogate: dict[str, Any] = at("search.surrogate")

    @property
    def surrogate_settings(self) -> SurrogateSettings:
        """Settings of the Gaussian process."""
        bounds = {name: tuple(self.surrogate[name]) for name in ("variance", "length_scale")}
        return SurrogateSettings(**{**self.surrogate, **bounds})


@job
def search(
    *,
    ensemble: str,
    scheduled: list[str],
    scan: str,
    scan_errors: str,
    hyperparameters: str,
    trace: str,
    settings: BayesianSearch,
) -> None:
    """Write the whole trace of the search and its best point."""
    import pandas as pd  # jobs from the cache start without it

    identifier = settings.forecaster
    validator = settings.search.point_validator(identifier, ensemble, scheduled)
    strategy = make_strategy(str(parsed(identifier).validation))
    reservoir = settings.search.networks.reservoir_seed(identifier)
    evaluations = network_search.search(
        validator,
        settings.search.space,
        strategy,
        read_evaluations(read_table(scan).to_dict("records"), scan_errors),
        settings.points,
        network_search.optimiser_seed(reservoir, settings.case, strategy.name),
        settings.surrogate_settings,
    )
    uncertainty = objective_uncertainty(
        np.array([evaluation.validation.log_errors for evaluation in evaluations])
    )
    table = pd.DataFrame([evaluation.record() for evaluation in evaluations])
    write_table(trace, table.assign(**uncertainty))
    write_json(hyperparameters, network_search.best(evaluations).record(), settings.provenance)
