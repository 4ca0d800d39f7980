"""Modules that stand alone: durations, events, laminarisation, random streams, names."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from burstcast.base import durations, random_streams
from burstcast.base.natural_order import natural_order
from burstcast.data.events import upward_crossings
from burstcast.data.laminarisation import first_laminar_step, is_laminar


@given(st.floats(1e-3, 10, allow_subnormal=False), st.floats(1e-4, 0.1, allow_subnormal=False))
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


def test_durations_are_rounded_down_and_rounding_errors_cost_no_step():
    assert durations.steps_per_lyapunov_time(0.1, 0.1) == 100
    assert durations.steps(9.5, 61) == 579
    assert durations.positive_steps(0.1, 10, "washout_lt") == 1
    with pytest.raises(ValueError, match=r"washout_lt is 0\.05 Lyapunov times, .* has 10"):
        durations.positive_steps(0.05, 10, "washout_lt")


@given(st.integers(1, 400), st.integers(1, 300), st.integers(1, 1000))
def test_multiples_of_a_resolution_lose_no_step(multiple, parts, steps):
    # a duration that floating-point numbers know as a sum of parts
    total = sum([1 / parts] * multiple)
    assert durations.steps(total, steps) == multiple * steps // parts


# -- events ----------------------------------------------------------------------------------------

VALUES = st.sampled_from([0.0, 0.09, 0.1, 0.2, np.nan])


@given(npst.arrays(np.float64, (3, 12), elements=VALUES))
def test_upward_crossings_start_where_the_threshold_is_reached_from_below(observable):
    crossings = upward_crossings(observable, 0.1)
    for row in range(3):
        for step in range(12):
            reached = observable[row, step] >= 0.1
            above_before = step == 0 or observable[row, step - 1] >= 0.1
            assert crossings[row, step] == (reached and not above_before)


@given(npst.arrays(np.float64, (3, 4, 5), elements=VALUES), st.sampled_from([0, 1, 2, -1]))
def test_time_may_be_any_axis(observable, axis):
    expected = np.moveaxis(upward_crossings(np.moveaxis(observable, axis, -1), 0.1), -1, axis)
    np.testing.assert_array_equal(upward_crossings(observable, 0.1, axis), expected)


# -- laminarisation --------------------------------------------------------------------------------


def test_a_value_above_the_threshold_is_laminar_and_the_threshold_itself_is_not():
    above = np.nextafter(0.48, 1)
    values = np.array([[0.1, 0.48, above], [np.nan, np.inf, 0.2]])
    expected = [[False, False, True], [False, True, False]]
    np.testing.assert_array_equal(is_laminar(values, 0.48), expected)
    assert not is_laminar(values, None).any()


@pytest.mark.parametrize("axis", [0, 1, -1])
def test_the_first_laminar_step_is_that_of_a_plain_loop(axis):
    observable = np.random.default_rng(1).uniform(size=(40, 40))
    observable[:3], observable[:, :3] = 0.1, 0.1
    series = np.moveaxis(observable, axis, 0).T
    steps = [next((i for i, k in enumerate(values) if k > 0.97), -1) for values in series]
    assert -1 in steps
    assert max(steps) > 3
    assert first_laminar_step(observable, 0.97, axis=axis).tolist() == steps
    assert (first_laminar_step(observable, None, axis=axis) == -1).all()


# -- random streams --------------------------------------------------------------------------------

NAMES = st.lists(st.one_of(st.text(max_size=6), st.integers(-5, 10**20)), min_size=1, max_size=4)


def first_numbers(*names, root_seed=2022):
    return random_streams.stream(root_seed, *names).random(4).tolist()


@given(NAMES, NAMES)
@example(["a", "b"], ["ab"])
@example(["a", "b"], ["a\x1fb"])
@example(["a", "b"], ["a'\x1f'b"])
@example(["1"], [1])
@example(["reservoir", 11, 1], ["reservoir", 1, 11])
@example(["a"], ["a", ""])
def test_streams_are_the_same_only_if_their_names_are(left, right):
    same_names = [(type(name), name) for name in left] == [(type(name), name) for name in right]
    assert (first_numbers(*left) == first_numbers(*right)) == same_names


def test_streams_stay_what_they_are_by_root_seed_and_name():
    # results of finished campaigns hang on these numbers
    assert random_streams.stream(2022, "noise", "Re400", 3).integers(0, 10**9, 3).tolist() == STORED
    assert first_numbers("noise", 1, root_seed=1) != first_numbers("noise", 1, root_seed=2)
    assert first_numbers("noise", np.int64(3)) == first_numbers("noise", 3)
    sequence = random_streams.seed_sequence(5, "optimiser", 1)
    expected = np.random.Generator(np.random.PCG64(sequence)).random()
    assert random_streams.stream(5, "optimiser", 1).random() == expected


STORED = [810069763, 687754866, 766571384]


def test_what_is_no_name_is_refused():
    with pytest.raises(ValueError, match="root seed"):
        random_streams.stream(-1, "noise")
    with pytest.raises(ValueError, match="needs a name"):
        random_streams.stream(1)
    with pytest.raises(TypeError):
        random_streams.stream(1, 0.5)


def test_natural_order():
    names = ["Zeta", "alpha", "Re1000", "Re400", "Re412.5", "zeta", "b10", "b9"]
    assert sorted(names, key=natural_order) == [
        *("alpha", "b9", "b10", "Re400", "Re412.5", "Re1000", "Zeta", "zeta"),
    ]
