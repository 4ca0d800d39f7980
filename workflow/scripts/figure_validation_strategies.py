"""Draw the validation strategies on the first training series."""

from typing import Any

import numpy as np

from burstcast.figures.validation_strategies import ValidationLayout, validation_strategies
from burstcast.tuning.strategies.base import use_of_series
from burstcast.tuning.strategies.registry import make_strategy
from burstcast_workflow.figure_files import write_figure
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.storage import read_rows
from burstcast_workflow.time_unit import read_steps_per_lyapunov_time
from burstcast_workflow.validation_plans import validation_plan


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Draw where each strategy trains and validates."""
    lyapunov_time = read_steps_per_lyapunov_time(settings, inputs.lyapunov)
    observable = read_rows(inputs.ensemble, "observable", 0, 1)[0]
    plan = validation_plan(settings, lyapunov_time)
    length = len(observable)
    layouts = []
    for strategy in map(make_strategy, settings["validation"]):
        # how many more series there are changes nothing in the first one
        folds = strategy.folds(plan, plan.series, length)
        stop, starts = use_of_series(folds, 0)
        layouts.append(
            ValidationLayout(
                validation=strategy.name,
                title=strategy.title,
                washout=(0.0, plan.washout / lyapunov_time),
                training=(plan.washout / lyapunov_time, stop / lyapunov_time),
                intervals=np.array([(start, start + plan.interval) for start in starts])
                / lyapunov_time,
            )
        )
    figure = validation_strategies(
        np.arange(length) / lyapunov_time,
        observable,
        layouts,
        settings["event_threshold"],
        symbol=settings["symbol"],
    )
    write_figure(outputs, figure)


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
