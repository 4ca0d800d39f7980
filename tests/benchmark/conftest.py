"""A small case of the benchmark, whose data and forecasts take no time."""

from dataclasses import replace

import numpy as np
import pytest

from burstcast.benchmark import cases
from burstcast.benchmark.data import make_case

SMALL = replace(
    cases.CASES["Re400"],
    name="small",
    version=3,
    event_threshold=0.07,
    series=20,
    training_series=3,
    test_series=8,
    time_step=0.5,
    sampling_stride=2,
    duration=500.0,
    prediction_times_lt=(1.0, 2.0),
    horizon_events=5,
    longest_lead_time_lt=2.0,
    digest="",
)


@pytest.fixture
def small_is_known(monkeypatch):
    """The small case is one of the benchmark's."""
    monkeypatch.setitem(cases.CASES, SMALL.name, SMALL)


@pytest.fixture(scope="session")
def data():
    return make_case(SMALL)


@pytest.fixture(scope="session")
def true_observable(data):
    """True observable after each starting point of the test, ``(points, steps)``."""
    ahead = 1 + np.arange(data.task.steps)
    points = data.test.points
    return data.observable[points.series[:, np.newaxis], points.step[:, np.newaxis] + ahead]


@pytest.fixture(scope="session")
def facts(data):
    """Attributes of a file of forecasts."""
    return {"case": "small", "case_version": 3, "seed": data.seed}
