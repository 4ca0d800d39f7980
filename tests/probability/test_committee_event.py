"""An event as committees see it, laid out on one axis of time."""

import numpy as np

from burstcast.probability.committee_event import see_event


def test_forecasts_begin_after_what_was_observed():
    fans = [np.array([[5.0, 6.0], [7.0, 8.0]]), np.array([[9.0, 10.0]])]
    chances = np.arange(12.0).reshape(3, 2, 2)
    found = see_event(
        np.arange(5.0), np.array([1.0, 2.0, 3.0]), fans, [1, 2], [True, False], chances, 4
    )
    np.testing.assert_array_equal(found.time_lt, [-0.5, -0.25, 0, 0.25, 0.5])
    np.testing.assert_array_equal(found.observed, [1, 2, 3, np.nan, np.nan])
    nothing = [np.nan] * 3
    np.testing.assert_array_equal(
        found.forecast, [[*nothing, 5, 6], [*nothing, 7, 8], [*nothing, 9, 10]]
    )
    np.testing.assert_array_equal(found.committee, [0, 0, 1])
    np.testing.assert_array_equal(found.happened, [True, False])
    np.testing.assert_array_equal([found.votes, found.probability, found.alarm_threshold], chances)


def test_without_an_event_nothing_has_a_time():
    empty = np.empty(0)
    found = see_event(empty, empty, [np.empty((0, 0))], [1], [False], np.full((3, 1, 1), 0.5), 4)
    assert found.time_lt.size == found.forecast.size == found.committee.size == 0
    assert found.votes.shape == (1, 1)
