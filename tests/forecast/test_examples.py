"""Forecasts of the examples that figures show; which ones: test_example_events."""

from dataclasses import dataclass

import numpy as np
import pytest

from burstcast.data.starting_points import SeriesPoints
from burstcast.forecast.examples import (
    HorizonExample,
    evaluate_lead_times,
    forecast_observable,
    forecast_outcomes,
    horizon_example,
    outcome_examples,
    stretch,
)
from burstcast.forecast.horizon import HorizonSearch, prediction_horizons
from burstcast.forecast.windows import WindowSummaries
from helpers_forecasters import MadeUpForecaster


@dataclass(frozen=True)
class Drift(MadeUpForecaster):
    """Counts on from the last value and drifts off by a constant in each step."""

    drift: float

    def start(self, washout, parameters=None):
        return washout[-1].copy()

    def advance(self, memory, steps, parameters=None):
        rise = (1 + self.drift) * np.arange(1, steps + 1)
        outputs = memory[np.newaxis] + rise[:, np.newaxis, np.newaxis]
        return outputs, outputs[-1]


def first_component(state):
    return state[0]


SEARCH = HorizonSearch(
    longest_lead_time_lt=3.0,
    lead_time_step_lt=0.5,
    tolerance=1.0,
    washout=3,
    # odd: half a Lyapunov time is no whole number of steps
    steps_per_lyapunov_time=5,
)


def ramp(after):
    """An event at the end of a ramp of slope one, and what follows it."""
    before = SEARCH.steps_before_event
    truth = np.arange(before + 1 + after, dtype=np.float64)
    return truth[: before + 1, np.newaxis], truth


STARTS = [3.0, 2.5, 2.0, 1.5, 1.0, 0.5]


@pytest.mark.parametrize("drift", [0.0, 0.12, 0.3, 5.0])
def test_evaluations_agree_with_the_prediction_horizon(drift):
    observed, truth = ramp(after=4)
    event = SEARCH.steps_before_event
    horizon = prediction_horizons(
        Drift(drift), first_component, observed[np.newaxis], truth[np.newaxis, : event + 1], SEARCH
    )[0]
    found = evaluate_lead_times(Drift(drift), first_component, observed, truth, STARTS, SEARCH)
    success = found.evaluation_horizon_lt == found.evaluation_lead_time_lt
    assert (
        found.evaluation_lead_time_lt[success][0]
        if success.any()
        else found.evaluation_horizon_lt[-1]
    ) == horizon
    # by hand: the error grows by the drift in each step and is lost at 1
    steps = np.array([15, 12, 10, 7, 5, 2])
    accurate = np.array([sum(drift * (n + 1) < 1 for n in range(count)) for count in steps])
    expected = np.where(accurate == steps, STARTS, accurate / 5)
    np.testing.assert_allclose(found.evaluation_horizon_lt, expected)


def test_evaluations_begin_after_their_start_and_go_beyond_the_event():
    observed, truth = ramp(after=4)
    found = evaluate_lead_times(Drift(0.5), first_component, observed, truth, [2.0], SEARCH)
    start = SEARCH.steps_before_event - 10
    assert np.isnan(found.evaluation_forecast[0, : start + 1]).all()
    np.testing.assert_allclose(
        found.evaluation_forecast[0, start + 1 :], start + 1.5 * np.arange(1, 15)
    )
    # in Lyapunov times after the event, of five steps
    np.testing.assert_allclose(found.evaluation_time_lt, (np.arange(len(truth)) - start - 10) / 5)


def test_a_truth_that_ends_early_does_not_matter_after_the_event():
    observed, truth = ramp(after=4)
    whole = evaluate_lead_times(Drift(0.0), first_component, observed, truth, STARTS, SEARCH)
    truth[-3:] = np.nan
    cut = evaluate_lead_times(Drift(0.0), first_component, observed, truth, STARTS, SEARCH)
    np.testing.assert_array_equal(whole.evaluation_forecast, cut.evaluation_forecast)
    np.testing.assert_array_equal(whole.evaluation_horizon_lt, cut.evaluation_horizon_lt)


def test_the_event_that_is_nearest_to_the_wanted_horizon_is_shown():
    # starts in the order of the search; the horizon of one that reaches the event is its tau_e
    horizons = np.array([2.5, 1.0, 0.5, 0.3])
    assert horizon_example(horizons, STARTS, 1.1) == HorizonExample(1, (2.5, 2.0, 1.5, 1.0))
    assert horizon_example(horizons, STARTS, 0.2) == HorizonExample(2, (2.0, 1.5, 1.0, 0.5))
    # one with fewer evaluations than are shown, where there is no other
    assert horizon_example(horizons, STARTS, 2.4, 6) == HorizonExample(2, tuple(STARTS))
    assert horizon_example(horizons[:1], STARTS, 1.0) == HorizonExample(0, (3.0, 2.5))
    assert horizon_example(horizons[3:], STARTS, 1.0) is None


def test_outcomes_are_shown_beside_the_truth():
    truth = np.arange(20.0).reshape(2, 10)
    washouts = np.array([[[3.0], [4.0]], [[11.0], [12.0]]])
    points = SeriesPoints(np.array([0, 1]), np.array([4, 2]))
    how = {"before": 3, "reach": 4, "steps_per_lyapunov_time": 2}
    outcomes = ["false positive", "true positive"]
    found = forecast_outcomes(Drift(1.0), first_component, washouts, truth, points, outcomes, **how)
    np.testing.assert_array_equal(found.outcome, [1, 0])
    np.testing.assert_array_equal(found.example_time_lt, np.arange(-3, 5) / 2)
    np.testing.assert_array_equal(
        found.example_truth,
        [[1, 2, 3, 4, 5, 6, 7, 8], [np.nan, 10, 11, 12, 13, 14, 15, 16]],
    )
    np.testing.assert_array_equal(
        found.example_forecast, [[np.nan] * 4 + [6, 8, 10, 12], [np.nan] * 4 + [14, 16, 18, 20]]
    )
    nobody = SeriesPoints(np.empty(0, dtype=int), np.empty(0, dtype=int))
    none = forecast_outcomes(None, first_component, washouts[:0], truth, nobody, [], **how)
    assert none.example_forecast.shape == none.example_truth.shape == (0, 8)


def test_forecast_observable_keeps_points_apart():
    washouts = np.array([[[1.0], [2.0]], [[5.0], [7.0]], [[0.0], [0.0]]])
    np.testing.assert_array_equal(
        forecast_observable(Drift(0.0), first_component, washouts, 2), [[3, 4], [8, 9], [1, 2]]
    )


@pytest.mark.parametrize(
    ("first", "count", "expected"),
    [
        (1, 2, [1, 2]),
        (-2, 4, [np.nan, np.nan, 0, 1]),
        (3, 3, [3, np.nan, np.nan]),
        (9, 2, [np.nan, np.nan]),
        (-5, 2, [np.nan, np.nan]),
    ],
)
def test_stretch(first, count, expected):
    np.testing.assert_array_equal(stretch(np.arange(4.0), first, count), expected)


HIGH, LOW = 0.2, 0.05


def windows(*largest):
    """Summaries of points by the largest observable of five windows each; all begin low."""
    table = np.array(largest, dtype=np.float64)
    return WindowSummaries(first=np.full_like(table, LOW), largest=table)


def test_a_miss_that_is_no_error_of_timing_comes_first():
    burst_in_window = [LOW, LOW, HIGH, LOW, LOW]
    truth = windows(burst_in_window, burst_in_window, burst_in_window)
    early, never = [LOW, HIGH, LOW, LOW, LOW], [LOW] * 5
    where = {"first_window": 2, "windows": 1, "threshold": 0.1}
    quiet = np.full(3, LOW)
    assert outcome_examples(windows(early, never, early), truth, quiet, **where) == {
        "false negative": 1
    }
    assert outcome_examples(truth, windows(early, never, early), quiet, **where) == {
        "false positive": 1
    }
    # a marginal one is better than none
    marginal = outcome_examples(windows(early, early, early), truth, quiet, **where)
    assert list(marginal) == ["false negative"]
    # what had an event in its washout is not scored
    began = np.array([LOW, HIGH, LOW])
    assert outcome_examples(windows(early, never, early), truth, began, **where) == {
        "false negative": 2
    }
    # a hit beside an early forecast is no miss, however tall
    tall = [LOW, LOW, 2 * HIGH, LOW, LOW]
    both = outcome_examples(
        windows(tall, early), windows(tall, burst_in_window), quiet[:2], **where
    )
    assert both == {"true positive": 0, "false negative": 1}
