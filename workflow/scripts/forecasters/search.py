"""Search on from the grid by Bayesian optimisation, and pick the best hyperparameters."""

from typing import Any

import numpy as np
import pandas as pd

from burstcast import random_streams
from burstcast.tuning.hyperparameters import HyperparameterPoint
from burstcast.tuning.search import bayesian_search
from burstcast.tuning.strategies.registry import make_strategy
from burstcast.tuning.uncertainty import objective_uncertainty
from burstcast.tuning.validation import best
from burstcast_workflow.harness.job import Provenance, job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import write_json
from burstcast_workflow.harness.tables import read_table, write_table
from burstcast_workflow.identifiers import parsed
from burstcast_workflow.jobs.searches import (
    point_validator,
    read_log_errors,
    search_space,
    trace_rows,
)


@job
def search(
    *,
    ensemble: str,
    time_unit: str | list[str],
    scan: str,
    scan_errors: str,
    hyperparameters: str,
    trace: str,
    settings: Settings,
    provenance: Provenance,
) -> None:
    """Write the whole trace of the search and its best point."""
    name = parsed(settings["forecaster"])
    assert name.neurons is not None
    assert name.seed is not None
    strategy = make_strategy(str(name.validation))
    grid_rows = read_table(scan)
    own = (grid_rows["validation"] == strategy.name).to_numpy()
    rows: list[dict[str, Any]] = [
        {str(column): value for column, value in row.items()}
        for row in grid_rows[own].to_dict("records")
    ]
    of_grid = read_log_errors(scan_errors)
    log_errors = [of_grid[row] for row in np.flatnonzero(own)]
    grid: dict[HyperparameterPoint, float] = {}
    for row in rows:
        point = HyperparameterPoint(row["spectral_radius"], row["input_scaling"])
        grid[point] = min(row["objective"], grid.get(point, float("inf")))
    validator = point_validator(settings, settings["forecaster"], ensemble, time_unit)

    def evaluate(point: HyperparameterPoint) -> float:
        validations = validator(point, [strategy])
        rows.extend(trace_rows(rows[-1]["evaluation"] + 1, "bayesian", point, validations))
        log_errors.extend(validation.log_errors for validation in validations)
        return best(validations, strategy.name).objective

    seed = random_streams.seed_sequence(
        settings["random_seed"],
        "optimiser",
        settings["case"],
        name.neurons,
        strategy.name,
        name.seed,
    )
    bayesian_search(
        search_space(settings),
        list(grid.items()),
        settings["search.bayesian_points"],
        evaluate,
        int(seed.generate_state(1)[0] % 2**31),
    )
    chosen = min(rows, key=lambda row: row["objective"])
    uncertainty = objective_uncertainty(np.array(log_errors))
    write_table(trace, pd.DataFrame(rows).assign(**vars(uncertainty)))
    write_json(hyperparameters, {**chosen, "provenance": provenance})
