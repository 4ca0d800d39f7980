"""A small task, whose forecasts take no time."""

import pytest

from burstcast.benchmark.task import ForecastTask
from burstcast.forecast.windows import window_boundaries
from burstcast.systems.mfe import MoehlisFaisstEckhardt

LYAPUNOV_TIME = 61


@pytest.fixture(scope="session")
def task():
    """Forty points, forecast for three Lyapunov times; ten of the horizon."""
    return ForecastTask(
        case="small",
        version="3f",
        seed=2026,
        space=MoehlisFaisstEckhardt(400.0),
        points=40,
        boundaries=window_boundaries(0.5, 5, LYAPUNOV_TIME),
        prediction_times_lt=(1.0, 2.0),
        window_lt=1.0,
        resolution_lt=0.5,
        horizon_points=10,
        horizon_steps=122,
    )


@pytest.fixture(scope="session")
def facts(task):
    """Attributes of a file of forecasts."""
    return {"case": "small", "case_version": "3f", "seed": task.seed}
