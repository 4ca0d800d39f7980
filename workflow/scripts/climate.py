"""Let a network run freely from many points of the training set; keep its statistics."""

from typing import Any

from burstcast import durations
from burstcast.forecast.starting_points import segments
from burstcast.statistics.densities import bin_edges
from burstcast.statistics.long_term import (
    Fate,
    FixedPointCriterion,
    LongTermSettings,
    long_term_starting_points,
    run_long_term,
)
from burstcast.systems.registry import make_system
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.network_files import read_forecaster, training_series
from burstcast_workflow.statistics_files import write_statistics
from burstcast_workflow.storage import Variable
from burstcast_workflow.time_unit import read_steps_per_lyapunov_time


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write the network's long-term statistics and what became of each closed loop."""
    system = make_system(settings["system"], settings["parameters"])
    lyapunov_time = read_steps_per_lyapunov_time(settings, inputs.lyapunov)
    training = training_series(settings, inputs.ensemble)
    washout = durations.steps(settings["washout_lt"], lyapunov_time)
    points = long_term_starting_points(
        training.series,
        training.length,
        durations.steps(settings["start_spacing_lt"], lyapunov_time),
        washout,
        settings["starting_points"],
    )
    fixed_point = settings["stuck"]
    density = settings["density"]
    try:
        how = LongTermSettings(
            steps=round(settings["duration"] / settings["sampling_interval"]),
            edges=bin_edges(*density["range"], density["bins"]),
            laminarisation_threshold=settings["laminarisation_threshold"],
            fixed_point=FixedPointCriterion(
                fixed_point["variation"],
                fixed_point["above"],
                durations.steps(settings["stuck_interval_lt"], lyapunov_time),
            ),
        )
    except ValueError as error:
        raise ValueError(f"{error} (statistics.duration, statistics.stuck_interval_lt)") from error
    run = run_long_term(
        read_forecaster(inputs.network, settings["kernel"], settings["divergence_bound"]),
        system.observable,
        segments(training.observed, points, washout - 1, 0),
        how,
    )
    fates = ", ".join(f"{fate.value} {fate.name.lower()}" for fate in Fate)
    write_statistics(
        outputs.climate,
        run.statistics,
        provenance,
        {"fate": Variable(("start",), run.fates, "1", f"fate of each closed loop: {fates}")},
    )


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
