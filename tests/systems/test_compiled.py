"""Compiled time stepping against numpy's, bit by bit, and what is left to numpy."""

import dataclasses
from typing import ClassVar

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.systems.base import DynamicalSystem
from burstcast.systems.compiled import compiled_steps
from burstcast.systems.forced import ForcedSystem
from burstcast.systems.integration import integrate, integrate_observed, integrate_switched
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.registry import available_systems, make_system
from burstcast.systems.runge_kutta import step

MFE = MoehlisFaisstEckhardt(400.0)
PARAMETERS = {"mfe": {"reynolds": 400.0}}


class Expressions(DynamicalSystem):
    """Any right-hand side and observable, given as functions."""

    observable_name: ClassVar[str] = "x"
    observable_symbol: ClassVar[str] = "x"

    def __init__(self, dimension, right_hand_side, observable=lambda state: np.array(state[0])):
        object.__setattr__(self, "dimension", dimension)
        self._right_hand_side = right_hand_side
        self._observable = observable

    def right_hand_side(self, state):
        return self._right_hand_side(state)

    def observable(self, state):
        return self._observable(state)


def is_compiled(*systems, observed=False):
    return compiled_steps(systems, 0.25, observed) is not None


def by_numpy(system, state, time_step, steps):
    states = [state]
    for _ in range(steps):
        states.append(step(system, states[-1], time_step))
    return np.array(states)


def initial_states(system, count, seed):
    return np.random.default_rng(seed).normal(0.0, 0.3, (system.dimension, count))


# stiff equations in Fourier space step by a scheme of their own, ETDRK4
COMPILED = [name for name in available_systems() if name != "kuramoto_sivashinsky"]


@pytest.mark.parametrize("name", COMPILED)
def test_every_system_of_the_library_is_compiled(name):
    system = make_system(name, PARAMETERS.get(name, {}))
    assert is_compiled(system)
    assert is_compiled(system, observed=True)
    other = dataclasses.replace(system)
    assert is_compiled(system, ForcedSystem(other, [0.1] * system.dimension))


@settings(max_examples=25)
@given(
    *(st.floats(50.0, 3000.0), st.floats(2.0, 20.0), st.integers(0, 19), st.integers(1, 4)),
    *(st.integers(0, 4), st.integers(0, 3), st.integers(0, 1000)),
)
def test_the_bits_are_those_of_numpy(reynolds, length, batch, stride, samples, transient, seed):
    for system in (MoehlisFaisstEckhardt(reynolds, length_x=length), Lorenz63(rho=length)):
        state = initial_states(system, batch, seed)
        steps = samples * stride
        expected = by_numpy(system, state, 0.02, transient + steps)
        observable = system.observable(np.moveaxis(expected, 1, 0))
        states = integrate(system, state, 0.02, steps, stride)
        assert np.array_equal(states, expected[: steps + 1 : stride])
        assert states.flags.c_contiguous
        observed = integrate_observed(system, state, 0.02, steps, stride, transient)
        assert np.array_equal(observed.states, expected[transient::stride])
        assert np.array_equal(observed.largest_observable, observable[transient:].max(axis=0))


@settings(max_examples=25)
@given(
    *(st.integers(1, 19), st.integers(1, 4), st.integers(0, 9)),
    *(st.booleans(), st.integers(0, 1000)),
)
def test_each_step_obeys_the_system_of_its_choice(batch, stride, steps, forced, seed):
    last = ForcedSystem(MFE, [0.01 * i for i in range(9)]) if forced else MFE
    systems = (MFE, MoehlisFaisstEckhardt(2000.0), last)
    assert is_compiled(*systems)
    choice = np.random.default_rng(seed).integers(0, 3, (steps, batch)).astype(np.uint8)
    state = initial_states(MFE, batch, seed)
    together = integrate_switched(systems, choice, state, 0.25, stride)
    not_compiled = tuple(
        Expressions(9, lambda x, s=system: s.right_hand_side(np.asarray(x, np.float64)))
        for system in systems
    )
    assert compiled_steps(not_compiled, 0.25, False) is None
    assert np.array_equal(integrate_switched(not_compiled, choice, state, 0.25, stride), together)
    for trajectory in range(batch):
        states = [state[:, [trajectory]]]
        for number in choice[: steps - steps % stride, trajectory]:
            states.append(step(systems[number], states[-1], 0.25))
        assert np.array_equal(together[..., [trajectory]], np.array(states)[::stride])


OPERATIONS = (
    lambda a, b: a + b,
    lambda a, b: a - b,
    lambda a, b: a * b,
    lambda a, b: a / (b * b + 1.0),
    lambda a, b: 0.3 - a,
    lambda a, b: np.float64(0.7) * a + 2 * b,
    lambda a, b: 1.0 / (a**2 + 0.5),
    lambda a, b: np.sqrt(np.square(a) + 0.1) - (-b),
    lambda a, b: np.array(0.1) * a - +b,
    lambda a, b: (0.1 * a) ** 3 / (1.0 + b**4.0),
)


@settings(max_examples=40)
@given(
    choices=st.lists(
        st.tuples(st.integers(0, len(OPERATIONS) - 1), st.integers(0, 20), st.integers(0, 20)),
        min_size=1,
        max_size=20,
    ),
    seed=st.integers(0, 1000),
)
def test_any_composition_of_what_can_be_compiled(choices, seed):
    def right_hand_side(state):
        values = list(state)
        for operation, first, second in choices:
            left, right = values[first % len(values)], values[second % len(values)]
            values.append(OPERATIONS[operation](left, right))
        return np.array([values[-1], values[-2], values[-3]]) * 0.1

    system = Expressions(3, right_hand_side, lambda state: state[2] - state[0])
    assert is_compiled(system, observed=True)
    state = initial_states(system, 11, seed)
    expected = by_numpy(system, state, 0.25, 3)
    assert np.array_equal(integrate(system, state, 0.25, 3), expected)
    largest = (expected[:, 2] - expected[:, 0]).max(axis=0)
    assert np.array_equal(integrate_observed(system, state, 0.25, 3).largest_observable, largest)


def different_order(state):
    first = 0.1 if state.dtype == object else 0.3
    return state + first + (0.4 - first)


NOT_COMPILED = {
    "function": np.sin,
    "power": lambda x: (x * x) ** 1.5,
    "large power": lambda x: x**17,
    "power by numpy": lambda x: np.power(x, 3),
    "decision": lambda x: np.where(x > 0.0, -x, x),
    "branch": lambda x: -x if (x == x).all() else x,
    "rare branch": lambda x: x if (x == 0.0).any() else -x,
    "conversion": lambda x: -np.asarray(x, dtype=np.float64),
    "float array": lambda x: np.stack([np.full(x.shape[1:], 1.0) * x[1], x[0]]).astype(float),
    "wrong shape": lambda x: -x + np.zeros((2, 11)) if x.shape[1] == 11 else np.zeros((2, 5)),
    "other bits": different_order,
    "long": lambda x: sum((x * i for i in range(2000)), x) * 1e-7,
}


@pytest.mark.parametrize("name", NOT_COMPILED)
def test_what_cannot_be_compiled_is_left_to_numpy(name):
    system = Expressions(2, NOT_COMPILED[name])
    assert not is_compiled(system)
    state = initial_states(system, 11, 1)
    assert np.array_equal(integrate(system, state, 0.25, 4), by_numpy(system, state, 0.25, 4))
    assert np.array_equal(
        integrate_observed(system, state, 0.25, 4).largest_observable,
        by_numpy(system, state, 0.25, 4)[:, 0].max(axis=0),
    )


def test_an_observable_that_cannot_be_compiled_is_left_to_numpy():
    system = Expressions(2, lambda x: -x, lambda x: np.abs(x[0]))
    assert is_compiled(system)
    assert not is_compiled(system, observed=True)
    state = initial_states(system, 11, 1)
    observed = integrate_observed(system, state, 0.25, 4)
    assert np.array_equal(observed.largest_observable, np.abs(state[0]))


def test_an_error_of_the_system_is_raised_by_numpy():
    def fails(state):
        raise ZeroDivisionError("of the system")

    with pytest.raises(ZeroDivisionError, match="of the system"):
        integrate(Expressions(2, fails), np.zeros((2, 3)), 0.25, 1)


def test_observables_may_be_undefined_and_return_the_state_itself():
    system = Expressions(1, lambda x: 0.0 * x + 1.0, lambda x: np.sqrt(x[0]))
    assert is_compiled(system, observed=True)
    with np.errstate(invalid="ignore"):
        observed = integrate_observed(system, np.array([[-0.5, 0.5]]), 0.25, 4)
    assert np.isnan(observed.largest_observable[0])
    assert observed.largest_observable[1] == np.sqrt(1.5)
    system = Expressions(1, lambda x: 0.0 * x + 1.0, lambda x: x[0])
    observed = integrate_observed(system, np.array([[0.5, 1.0]]), 0.25, 4)
    assert np.array_equal(observed.states[0], [[0.5, 1.0]])
    assert np.array_equal(observed.largest_observable, [1.5, 2.0])


@pytest.mark.parametrize(
    ("choice", "message"),
    [
        (np.zeros((4, 3)), r"shape \(steps, 2\), not \(4, 3\)"),
        (np.zeros(2), "shape"),
        (np.full((4, 2), 2), "between systems 0 to 1"),
        (np.full((4, 2), -1), "between systems 0 to 1"),
        (np.full((4, 2), 0.5), "numbers of systems, not of type float64"),
    ],
)
def test_bad_choices_raise(choice, message):
    with pytest.raises(ValueError, match=message):
        integrate_switched((MFE, MFE), choice, np.zeros((9, 2)), 0.25)
