from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from test_control_strategies import EQUATIONS, experiment

from burstcast.control.strategies.prediction_triggered import PredictionTriggered
from burstcast.control.windowed.example import simulate_event, suppressed_event_times
from burstcast.control.windowed.outcome import largest_suppressed_event
from burstcast.forecast.examples import forecast_observable

THRESHOLD = 1.0


def test_times_of_a_single_event() -> None:
    observable = np.array([0, 0, 0.5, 0.9, 1.0, 3.0, 2.0, 0.9, 0.1])
    assert suppressed_event_times(observable, THRESHOLD, 2, (3, 6)) == (2, 4, 5, 7)


def test_an_earlier_and_a_later_event_are_not_looked_at() -> None:
    observable = np.array([9, 0, 5.0, 0.9, 1.1, 0.5, 0, 7.0, 0])
    assert suppressed_event_times(observable, THRESHOLD, 1, (3, 6)) == (1, 4, 4, 5)


def test_an_event_that_is_under_way_at_the_end() -> None:
    observable = np.array([0, 0, 0.5, 1.5, 2.0])
    assert suppressed_event_times(observable, THRESHOLD, 0, (1, 4)) == (0, 3, 4, 4)


@pytest.mark.parametrize("observable", [[0, 0, 0, 2.0], [0, 2.0, 2.0, 2.0]])
def test_an_event_outside_the_window_is_refused(observable: list[float]) -> None:
    with pytest.raises(ValueError, match="does not cross"):
        suppressed_event_times(np.array(observable), THRESHOLD, 0, (1, 2))


def test_an_event_is_followed_again_as_it_was_found():
    strategy, found = PredictionTriggered(1.0, 1.0), None
    flows = experiment(30)
    timing = strategy.timing(flows.schedule)
    followed = strategy.simulate(
        flows, strategy.monitor(flows, [EQUATIONS]), noise=None, keep_states=True
    )
    chosen = largest_suppressed_event(followed, None)
    assert chosen is not None
    found = simulate_event(chosen, strategy, flows, EQUATIONS, None)
    steps = np.rint(found.time_lt * timing.steps_per_lyapunov_time).astype(int)
    shown = chosen.alarm_step + steps
    np.testing.assert_array_equal(np.diff(shown), 1)
    assert steps[0] == max(-20, -chosen.alarm_step)
    np.testing.assert_allclose(found.uncontrolled, followed.uncontrolled[chosen.flow, shown])
    np.testing.assert_allclose(found.controlled, followed.controlled[chosen.flow, shown])
    # the equations, from the true state: what happens if nobody acts
    ahead = (steps > 0) & (steps <= timing.window_end)
    np.testing.assert_array_equal(np.isfinite(found.forecast), ahead)
    np.testing.assert_allclose(found.forecast[ahead], found.uncontrolled[ahead], rtol=1e-6)
    np.testing.assert_allclose(found.actuation_lt, [0.0, 1.5])
    states = followed.uncontrolled_states[chosen.flow, shown[found.mark]]
    np.testing.assert_allclose(found.uncontrolled_state, states)
    assert found.uncontrolled[found.mark[2]] == found.uncontrolled[found.mark[1] :].max()
    assert found.controlled_state.shape == (4, 9)


def test_the_forecast_of_an_event_begins_with_what_was_observed():
    strategy, flows = PredictionTriggered(1.0, 1.0), experiment(30)
    timing = strategy.timing(flows.schedule)
    monitor = strategy.monitor(flows, [EQUATIONS])
    quiet = strategy.simulate(flows, monitor, noise=None, keep_states=True)
    chosen = largest_suppressed_event(quiet, None)
    assert chosen is not None
    # so little that the same alarm is raised, and yet more than rounding
    noise = np.random.default_rng(3).normal(0.0, 1e-7, (30, timing.length, 9))
    found = simulate_event(chosen, strategy, flows, EQUATIONS, noise)
    washout = slice(chosen.alarm_step + 1 - timing.washout, chosen.alarm_step + 1)
    observed = quiet.controlled_states[chosen.flow, washout] + noise[chosen.row, washout]
    expected = forecast_observable(
        EQUATIONS, flows.system.observable, observed[np.newaxis], timing.window_end
    )
    forecast = found.forecast[np.isfinite(found.forecast)]
    np.testing.assert_allclose(forecast, expected[0], rtol=1e-9)


def test_an_event_may_end_with_the_last_step_that_counts() -> None:
    strategy, flows = PredictionTriggered(1.0, 1.0), experiment(30)
    followed = strategy.simulate(flows, strategy.monitor(flows, [EQUATIONS]), noise=None)
    chosen = largest_suppressed_event(followed, None)
    assert chosen is not None
    timing = followed.timing
    end = chosen.alarm_step + timing.window_end + timing.window_start

    def until(step: int) -> object:
        last = SimpleNamespace(
            window_start=timing.window_start, window_end=timing.window_end, counted_until=step
        )
        return largest_suppressed_event(replace(followed, timing=last), None)

    assert until(end) == chosen
    assert until(end - 1) != chosen


def test_without_an_event_nothing_is_followed():
    flows = experiment(2)
    found = simulate_event(None, PredictionTriggered(1.0, 1.0), flows, EQUATIONS, None)
    assert found.time_lt.size == found.mark.size == found.uncontrolled_state.size == 0
    np.testing.assert_allclose(found.actuation_lt, [0.0, 1.5])
