"""How validation strategies lay out their folds, from a job's settings."""

from collections.abc import Mapping
from typing import Any

from burstcast import durations
from burstcast.tuning.strategies.base import ValidationPlan

Settings = Mapping[str, Any]


def validation_plan(settings: Settings, steps_per_lyapunov_time: int) -> ValidationPlan:
    """Parameters of the validation strategies, in steps."""
    recycle = settings["case.recycle_validation"]
    return ValidationPlan(
        washout=durations.steps(settings["washout_lt"], steps_per_lyapunov_time),
        interval=durations.steps(settings["search.interval_lt"], steps_per_lyapunov_time),
        series=recycle["series"],
        intervals=recycle["intervals_per_series"],
    )
