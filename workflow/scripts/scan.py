"""Validate a reservoir on the grid of the search, by both strategies of the paper."""

from typing import Any

import pandas as pd

from burstcast.tuning.hyperparameters import SearchSpace
from burstcast.tuning.strategies.recycle import RecycleValidation
from burstcast.tuning.strategies.single_shot import SingleShotValidation
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.searches import point_validator, trace_rows
from burstcast_workflow.table_files import write_table


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write the objective at every point, for every strategy and Tikhonov parameter."""
    space = SearchSpace(tuple(settings["spectral_radius"]), tuple(settings["input_scaling"]))
    validator = point_validator(settings, inputs)
    strategies = (SingleShotValidation(), RecycleValidation())
    rows = []
    for number, point in enumerate(space.grid(settings["grid"])):
        rows += trace_rows(number, "grid", point, validator(point, strategies))
    write_table(outputs.scan, pd.DataFrame(rows))


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
