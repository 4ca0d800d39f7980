"""Search on from the grid by Bayesian optimisation, and pick the best hyperparameters."""

from typing import Any

import pandas as pd

from burstcast import random_streams
from burstcast.tuning.hyperparameters import HyperparameterPoint, SearchSpace
from burstcast.tuning.search import bayesian_search
from burstcast.tuning.strategies.registry import make_strategy
from burstcast.tuning.validation import best
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.searches import point_validator, trace_rows
from burstcast_workflow.storage import write_json
from burstcast_workflow.table_files import read_table, write_table


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write the whole trace of the search and its best point."""
    strategy = settings["validation"]
    scan = read_table(inputs.scan)
    trace = scan[scan["validation"] == strategy].to_dict("records")
    grid: dict[HyperparameterPoint, float] = {}
    for row in trace:
        point = HyperparameterPoint(row["spectral_radius"], row["input_scaling"])
        grid[point] = min(row["objective"], grid.get(point, float("inf")))
    validator = point_validator(settings, inputs)

    def evaluate(point: HyperparameterPoint) -> float:
        validations = validator(point, [make_strategy(strategy)])
        trace.extend(trace_rows(trace[-1]["evaluation"] + 1, "bayesian", point, validations))
        return best(validations, strategy).objective

    seed = random_streams.seed_sequence(
        settings["random_seed"],
        "optimiser",
        settings["case"],
        settings["neurons"],
        strategy,
        settings["seed"],
    )
    bayesian_search(
        SearchSpace(tuple(settings["spectral_radius"]), tuple(settings["input_scaling"])),
        list(grid.items()),
        settings["bayesian_points"],
        evaluate,
        int(seed.generate_state(1)[0] % 2**31),
    )
    chosen = min(trace, key=lambda row: row["objective"])
    write_table(outputs.search, pd.DataFrame(trace))
    write_json(outputs.hyperparameters, {**chosen, "provenance": provenance})


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
