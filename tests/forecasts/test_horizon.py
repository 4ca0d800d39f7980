"""Prediction horizons against the paper's procedure, one event and one start at a time."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.base.resampling import bootstrap_weights, percentile_interval
from burstcast.forecasts import horizon
from burstcast.forecasts.horizon import (
    HorizonSearch,
    accurate_steps,
    prediction_horizons,
    resampled_averages,
)
from helpers_library import MadeUpForecaster

SEARCH = HorizonSearch(
    longest_lead_time_lt=4.0,
    lead_time_step_lt=0.5,
    largest_error=0.125,
    washout=5,
    steps_per_lyapunov_time=13,
)


def first(states):
    return states[0]


SLOPE = 3.0
"""Of the true signal, which is a straight line: beside a step of it every tolerance is small."""


class Drifting(MadeUpForecaster):
    """Follows the line from the last observation on, and drifts off at a speed that it tells.

    It also hides in its memory how far it is, as a reservoir's state does.
    """

    def start(self, washout):
        assert washout.shape[0] == SEARCH.washout
        return np.stack([washout[-1, 1], np.zeros(washout.shape[2]), washout[-1, 0]])

    def advance(self, memory, steps):
        speed, passed, value = memory
        ahead = passed + np.arange(1, steps + 1, dtype=np.float64)[:, np.newaxis]
        drift = np.where(speed < 0, np.where(ahead > -speed, np.nan, 0.0), speed * ahead)
        outputs = np.stack([value + SLOPE * ahead + drift, np.zeros_like(drift)], axis=1)
        return outputs, np.stack([speed, passed + steps, value])


def events(speeds):
    """Events of lines with different ends, observed with the forecaster's speed of drift."""
    count, length = speeds.shape
    truth = 100.0 * np.arange(count)[:, np.newaxis] + SLOPE * np.arange(length)
    return np.stack([truth, speeds], axis=2), truth


def horizon_by_hand(speeds, search):
    """One event: start by start, step by step, in whole steps until the last line."""
    event = len(speeds) - 1
    tau = search.longest_lead_time_lt
    while True:
        start = event - math.floor(tau * search.steps_per_lyapunov_time + 1e-9)
        accurate = 0
        for step in range(start + 1, event + 1):
            speed, ahead = speeds[start], step - start
            error = (math.nan if ahead > -speed else 0.0) if speed < 0 else speed * ahead
            if not abs(error) < search.largest_error:
                break
            accurate += 1
        if accurate == event - start:
            return tau
        shorter = tau - search.lead_time_step_lt
        if shorter * search.steps_per_lyapunov_time < 1 - 1e-6:
            return accurate / search.steps_per_lyapunov_time
        tau = shorter


# binary fractions: errors are exact, those that equal the tolerance included
SPEEDS = st.one_of(
    st.sampled_from([0.0, 0.125, 1.0, -1.0, -2.0]),
    st.integers(0, 40).map(lambda number: number / 2048),
    st.integers(-60, -1).map(float),
)


@settings(max_examples=80)
@given(
    st.data(),
    # not always a multiple: on to the last that is positive, and at least a step
    st.sampled_from([(4.0, 0.5), (2.0, 2.0), (2.0, 0.75), (0.5, 0.5), (0.3, 0.1), (1.0, 0.97)]),
    st.integers(1, 20),
    st.integers(0, 7),
)
def test_horizons_are_those_of_the_papers_procedure(data, starts, between_checks, count):
    search = replace(SEARCH, longest_lead_time_lt=starts[0], lead_time_step_lt=starts[1])
    length = search.steps_before_event + 1
    speeds = np.array(
        [data.draw(st.lists(SPEEDS, min_size=length, max_size=length)) for _ in range(count)]
    ).reshape(count, length)
    expected = [horizon_by_hand(row.tolist(), search) for row in speeds]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(horizon, "STEPS_BETWEEN_CHECKS", between_checks)
        patch.setattr(horizon, "EVENTS_PER_BATCH", data.draw(st.integers(1, 5)))
        horizons = prediction_horizons(Drifting(), first, *events(speeds), search)
    np.testing.assert_allclose(horizons, expected, rtol=1e-13)


def test_a_forecast_is_given_up_once_it_is_lost(monkeypatch):
    monkeypatch.setattr(horizon, "STEPS_BETWEEN_CHECKS", 4)

    class Watched(Drifting):
        def __init__(self):
            self.work = []

        def advance(self, memory, steps):
            self.work.append((steps, memory.shape[-1]))
            return super().advance(memory, steps)

    forecaster = Watched()
    washouts = np.zeros((SEARCH.washout, 2, 3))
    washouts[-1, 1] = [-3, -6, 1.0]
    washouts[-1, 0] = [0, 50, 7]
    truth = washouts[-1, 0] + SLOPE * np.arange(1, 51)[:, np.newaxis]
    assert accurate_steps(forecaster, first, washouts, truth, 0.1).tolist() == [3, 6, 0]
    assert forecaster.work == [(4, 3), (4, 1)]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"largest_error": 0.0}, "event threshold must exceed the mean"),
        ({"largest_error": -0.01}, "event threshold must exceed the mean"),
        ({"largest_error": math.nan}, "event threshold must exceed the mean"),
        ({"lead_time_step_lt": 0.0}, "must decrease by a step"),
        ({"lead_time_step_lt": 4.5}, "must decrease by a step"),
        ({"longest_lead_time_lt": 0.05, "lead_time_step_lt": 0.05}, "shorter than a step"),
    ],
)
def test_impossible_searches_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        replace(SEARCH, **change)


def test_segments_of_another_length_are_refused():
    observed, truth = events(np.zeros((2, SEARCH.steps_before_event)))
    with pytest.raises(ValueError, match="do not fit the search"):
        prediction_horizons(Drifting(), first, observed, truth, SEARCH)


# -- bootstrap samples of events -------------------------------------------------------------------


@given(st.lists(st.floats(0, 10), min_size=1, max_size=12), st.integers(0, 100))
def test_averages_are_those_of_what_was_drawn(horizons, seed):
    values = np.array(horizons)
    weights = bootstrap_weights(values.size, 20, np.random.default_rng(seed))
    means, medians = resampled_averages(values, weights)
    for weight, mean, median in zip(weights, means, medians, strict=True):
        drawn = np.repeat(values, weight)
        assert mean == pytest.approx(drawn.mean(), abs=1e-12)
        assert median == pytest.approx(np.median(drawn), abs=1e-12)


def test_without_events_there_is_no_average():
    means, medians = resampled_averages(np.empty(0), np.empty((5, 0), dtype=np.int64))
    assert means.size == medians.size == 0
    assert np.isnan(percentile_interval(means, 0.95)).all()
