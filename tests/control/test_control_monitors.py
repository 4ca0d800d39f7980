from dataclasses import replace

import numpy as np
import pytest
from helpers_control import PAPER
from test_control_strategies import Script

from burstcast.control.monitors.forecast import ForecastMonitor
from burstcast.control.monitors.observed import ObservedMonitor
from burstcast.control.monitors.random import RandomMonitor
from burstcast.control.timing import Timing

TIMING = Timing(
    prediction_time_lt=1.0,
    window_lt=1.0,
    span_lt=3.0,
    washout=2,
    steps_per_lyapunov_time=3,
    sampling_stride=2,
    time_step=0.1,
)


def test_alarm_is_a_crossing_in_the_window_of_steps_3_to_6() -> None:
    forecasts = np.array(
        [
            [0, 0, 0, 0, 0, 1],  # crosses at its last step
            [0, 0, 0, 1, 0, 0],  # crosses at its first possible step
            [0, 0, 1, 1, 1, 1],  # is above at its first step
            [1, 1, 0, 0, 0, 0],  # was above before it
            [0, 1, 0, 1, 0, 0],  # crosses again
            [0, 0, 0, np.nan, np.nan, np.nan],  # diverges
            [0, 0, 0, 0, 0, 0.999],  # stays below
        ],
        dtype=np.float64,
    )
    monitor = ForecastMonitor(Script(forecasts.T), lambda states: states[0], TIMING, threshold=1.0)
    flows = np.arange(7)
    alarms = monitor.alarms(flows, np.zeros_like(flows), np.zeros((2, 1, 7)))
    assert alarms.tolist() == [True, True, False, False, True, False, False]


def test_random_alarms_take_each_flow_s_own_numbers() -> None:
    draws = np.array([[0.1, 0.9], [0.3, 0.2]])
    monitor = RandomMonitor(0.3, draws)
    nothing = np.zeros((1, 1, 3))
    alarms = monitor.alarms(np.array([1, 0, 1]), np.array([1, 1, 0]), nothing)
    assert alarms.tolist() == [True, False, False]


def test_the_actuator_is_reversed_where_the_push_asked_for_is_negative() -> None:
    washout = np.array([[[-1.0, 0.0, 1.0, -2.0]]])
    monitor = ObservedMonitor(lambda states: np.abs(states[0]), 1.0, lambda states: states[0])
    flows = np.arange(4)
    found = monitor.decide(flows, np.zeros_like(flows), washout)
    assert found.alarm.tolist() == [True, False, True, True]
    assert found.reverse.tolist() == [True, False, False, True]


@pytest.mark.parametrize("probability", [-0.1, 1.1, np.nan])
def test_random_alarms_need_a_probability(probability: float) -> None:
    with pytest.raises(ValueError, match="must lie in"):
        RandomMonitor(probability, np.zeros((1, 1)))


def test_most_forecasts_of_the_paper_s_control() -> None:
    # at 0, 1, ..., 21 Lyapunov times, and one to spare
    assert PAPER.most_forecasts == 23
    assert replace(PAPER, prediction_time_lt=2.0).most_forecasts == 24
