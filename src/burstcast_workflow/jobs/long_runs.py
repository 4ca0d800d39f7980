"""Long runs of a job's forecaster: where they start."""

from collections.abc import Mapping, Sequence
from typing import Any

from burstcast import durations
from burstcast.arrays import FloatArray
from burstcast.forecast.starting_points import segments
from burstcast.forecasters.base import Forecaster
from burstcast.statistics.long_term import long_term_starting_points
from burstcast_workflow.jobs.data import training_states
from burstcast_workflow.jobs.forecasters import seen_rows
from burstcast_workflow.jobs.time_unit import lyapunov_time

Settings = Mapping[str, Any]


def long_run_washouts(
    settings: Settings, ensemble: str, time_unit: str | Sequence[str], who: Forecaster
) -> FloatArray:
    """What a forecaster is given before each of its long runs.

    Parameters
    ----------
    settings
        Of a stage of long runs.
    ensemble, time_unit
        Inputs of the job.
    who
        Who forecasts.

    Returns
    -------
    States up to each starting point, ``(points, steps, dimension)``.
    """
    steps = lyapunov_time(settings, time_unit)
    true = training_states(settings, ensemble)
    states = seen_rows(who, settings, ensemble, 0, true)
    washout = durations.steps(settings["washout_lt"], steps)
    points = long_term_starting_points(
        len(states),
        states.shape[1],
        durations.steps(settings["statistics.start_spacing_lt"], steps),
        washout,
        settings["statistics.starting_points"],
    )
    return segments(states, points, washout - 1, 0)
