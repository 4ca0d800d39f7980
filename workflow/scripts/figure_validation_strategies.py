"""Draw the validation strategies on the first training series."""

from typing import Any

import numpy as np

from burstcast import durations
from burstcast.figures.validation_strategies import ValidationLayout, validation_strategies
from burstcast.tuning.plan import ValidationPlan
from burstcast_workflow.figure_files import write_figure
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.storage import read_rows
from burstcast_workflow.time_unit import steps_per_lyapunov_time


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Draw where each strategy trains and validates."""
    lyapunov_time = steps_per_lyapunov_time(settings, inputs.lyapunov)
    observable = read_rows(inputs.ensemble, "observable", 0, 1)[0]
    plan = ValidationPlan(
        washout=durations.steps(settings["washout_lt"], lyapunov_time),
        interval=durations.steps(settings["interval_lt"], lyapunov_time),
        recycle_series=settings["recycle_validation"]["series"],
        recycle_intervals=settings["recycle_validation"]["intervals_per_series"],
    )
    length = len(observable)
    cut = plan.single_shot_start(length)
    used = {"SSV": (cut, [cut]), "RV": (length, plan.recycle_starts())}
    layouts = []
    for validation in settings["validation"]:
        end, starts = used[validation]
        intervals = np.array([(start, start + plan.interval) for start in starts])
        layouts.append(
            ValidationLayout(
                validation=validation,
                washout=(0.0, plan.washout / lyapunov_time),
                training=(plan.washout / lyapunov_time, end / lyapunov_time),
                intervals=intervals / lyapunov_time,
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
