"""The parameters of the validation strategies from a job's settings."""

from collections.abc import Mapping
from typing import Any

from burstcast import durations
from burstcast.tuning.strategies.base import ValidationPlan


def validation_plan(settings: Mapping[str, Any], lyapunov_time: int) -> ValidationPlan:
    """Parameters of the validation strategies, in steps.

    Parameters
    ----------
    settings
        With ``washout_lt``, ``interval_lt`` and ``recycle_validation``.
    lyapunov_time
        Steps in a Lyapunov time.
    """
    recycle = settings["recycle_validation"]
    return ValidationPlan(
        washout=durations.steps(settings["washout_lt"], lyapunov_time),
        interval=durations.steps(settings["interval_lt"], lyapunov_time),
        series=recycle["series"],
        intervals=recycle["intervals_per_series"],
    )
