import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast import durations


@pytest.mark.parametrize(
    ("exponent", "steps"), [(0.0163, 61), (0.0135, 74), (0.0126, 79), (0.0121, 82)]
)
def test_lyapunov_times_of_the_paper(exponent, steps):
    assert durations.steps_per_lyapunov_time(exponent, 1.0) == steps


@pytest.mark.parametrize(("exponent", "interval", "steps"), [(0.1, 0.1, 100), (0.7, 0.01, 142)])
def test_rounding_errors_do_not_cost_a_step(exponent, interval, steps):
    assert durations.steps_per_lyapunov_time(exponent, interval) == steps


@given(
    st.floats(1e-3, 10, allow_subnormal=False),
    st.floats(1e-4, 0.1, allow_subnormal=False),
)
def test_a_lyapunov_time_is_the_last_step_before_its_end(exponent, interval):
    count = durations.steps_per_lyapunov_time(exponent, interval)
    exact = 1 / (Fraction(exponent) * Fraction(interval))
    assert count - Fraction(1, 10**6) <= exact < count + 1


@pytest.mark.parametrize(
    ("exponent", "interval", "message"),
    [
        (0, 1, "exponent must be positive"),
        (-0.01, 1, "exponent must be positive"),
        (math.nan, 1, "exponent must be positive"),
        (math.inf, 1, "exponent must be positive"),
        (0.01, 0, "interval must be positive"),
        (0.01, math.nan, "interval must be positive"),
        (0.9, 2, "shorter than one step"),
    ],
)
def test_what_gives_no_time_unit_is_refused(exponent, interval, message):
    with pytest.raises(ValueError, match=message):
        durations.steps_per_lyapunov_time(exponent, interval)


def test_durations_are_rounded_down_as_the_readings_say():
    assert durations.steps(0.5, 61) == 30  # half a Lyapunov time at Re = 400
    assert durations.steps(2, 61) == 122
    assert durations.steps(9.5, 61) == 579
    assert durations.steps(0, 61) == 0


@given(st.integers(1, 400), st.integers(1, 300), st.integers(1, 1000))
def test_multiples_of_a_resolution_lose_no_step(multiple, parts, steps):
    # a duration that floating-point numbers know as a sum of parts
    total = sum([1 / parts] * multiple)
    assert durations.steps(total, steps) == multiple * steps // parts


def test_durations_that_must_have_a_step():
    assert durations.positive_steps(0.1, 10, "washout_lt") == 1
    with pytest.raises(ValueError, match=r"washout_lt is 0\.05 Lyapunov times, .* has 10"):
        durations.positive_steps(0.05, 10, "washout_lt")
