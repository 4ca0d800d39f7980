"""The task: where forecasts of the prediction horizon start, and the digest of data."""

import numpy as np

from burstcast.benchmark.task import data_digest, horizon_starts
from burstcast.data.starting_points import SeriesPoints
from burstcast.forecast.horizon import HorizonSearch


def test_points_of_the_horizon_are_those_that_the_search_asks_for():
    """Each lead time of each event, once, and in an order that is not that of the lead times."""
    search = HorizonSearch(
        longest_lead_time_lt=2.0,
        lead_time_step_lt=0.5,
        tolerance=0.1,
        washout=30,
        steps_per_lyapunov_time=60,
    )
    # the second event is half a Lyapunov time after the first one, the last in another series
    events = SeriesPoints(np.array([4, 4, 6]), np.array([500, 530, 500]))
    event, step = horizon_starts(events, search, np.random.default_rng(1))
    begins = zip(events.series, events.step, strict=True)
    wanted = {(s, b - lead) for s, b in begins for lead in (30, 60, 90, 120)}
    before = search.steps_before_event
    found = list(zip(events.series[event], events.step[event] - before + step, strict=True))
    assert sorted(found) == sorted(wanted)
    assert len(found) == 9
    assert step.min() >= search.washout - 1
    assert (np.diff(step) > 0).any()
    assert (np.diff(step) < 0).any()


def test_rounding_errors_do_not_change_the_digest():
    data = np.random.default_rng(0).normal(size=(3, 50))
    assert data_digest([data]) == data_digest([data * (1 + 1e-15)])
    assert data_digest([data]) != data_digest([data + 1e-5])
    assert data_digest([np.zeros(3)]) == data_digest([-np.zeros(3)])
