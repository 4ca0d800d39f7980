"""Long runs of a job's forecaster: where they start, and how they are made."""

from burstcast import durations
from burstcast.arrays import FloatArray
from burstcast.data.starting_points import segments
from burstcast.forecasters.base import Forecaster
from burstcast.statistics.densities import SETTLED
from burstcast.statistics.long_term import (
    FixedPointCriterion,
    LongTermSettings,
    long_term_starting_points,
)
from burstcast_workflow.harness.settings import LONG_RUNS, Settings, concerning
from burstcast_workflow.jobs.data import density_edges, training_states
from burstcast_workflow.jobs.forecasters import seen_rows
from burstcast_workflow.jobs.time_unit import long_run_steps, lyapunov_time


def long_run_washouts(settings: Settings, ensemble: str, forecaster: Forecaster) -> FloatArray:
    """Washouts of a forecaster before each of its long runs, ``(points, steps, dimension)``."""
    steps = lyapunov_time(settings)
    true = training_states(settings, ensemble)
    states = seen_rows(forecaster, settings, ensemble, 0, true)
    washout = durations.steps(settings["washout_lt"], steps)
    points = long_term_starting_points(
        len(states),
        states.shape[1],
        durations.steps(settings["statistics.start_spacing_lt"], steps),
        washout,
        settings["statistics.starting_points"],
    )
    return segments(states, points, washout - 1, 0)


def long_term_settings(settings: Settings, ensemble: str) -> LongTermSettings:
    """Settings of long runs: their length, and when they are discarded.

    A run has settled where it varies less than a hundredth of the bins' range, unless the config
    says otherwise.
    """
    edges = density_edges(settings, ensemble)
    fixed_point = settings["case.fixed_point"] or {
        "variation": SETTLED * (edges[-1] - edges[0]),
        "above": edges[0],
    }
    interval = durations.steps(
        settings["statistics.fixed_point_interval_lt"], lyapunov_time(settings)
    )
    with concerning(LONG_RUNS):
        return LongTermSettings(
            steps=long_run_steps(settings, ensemble),
            edges=edges,
            laminarisation_threshold=settings["case.laminarisation_threshold"],
            fixed_point=FixedPointCriterion(
                fixed_point["variation"], fixed_point["above"], interval
            ),
        )
