"""The search for prediction horizons from a job's settings."""

from collections.abc import Mapping, Sequence
from typing import Any

from burstcast import durations
from burstcast.forecast.horizon import HorizonSearch
from burstcast_workflow.jobs.time_unit import lyapunov_time


def horizon_search(
    settings: Mapping[str, Any], time_unit: str | Sequence[str], mean_observable: float
) -> HorizonSearch:
    """Lead times that are tried, and the error at which a prediction is lost.

    Parameters
    ----------
    settings
        Of the job.
    time_unit
        The job's input of that name.
    mean_observable
        Mean over all data, which the error is measured against.
    """
    steps = lyapunov_time(settings, time_unit)
    distance = settings["case.event_threshold"] - mean_observable
    return HorizonSearch(
        longest_lead_time_lt=settings["horizon.longest_lead_time_lt"],
        lead_time_step_lt=settings["horizon.lead_time_step_lt"],
        tolerance=settings["horizon.tolerance"] * distance,
        washout=durations.steps(settings["washout_lt"], steps),
        steps_per_lyapunov_time=steps,
    )
