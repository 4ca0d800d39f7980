"""The Runge-Kutta scheme: order, reference solutions, grouping, and what is kept."""

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from burstcast.arrays import FloatArray
from burstcast.systems import integration
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.integration import integrate, integrate_observed
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.runge_kutta import step

MFE = MoehlisFaisstEckhardt(400.0)


@dataclass(frozen=True)
class Quadratic(DynamicalSystem):
    """dx/dt = x^2: solutions from positive values become infinite in finite time."""

    dimension: ClassVar[int] = 1
    observable_name: ClassVar[str] = "x"
    observable_symbol: ClassVar[str] = "x"

    def right_hand_side(self, state: FloatArray) -> FloatArray:
        return np.square(state)

    def jacobian(self, state: FloatArray) -> FloatArray:
        return 2.0 * state[np.newaxis]

    def observable(self, state: FloatArray) -> FloatArray:
        return np.array(state[0])


def initial_states(count: int, seed: int = 1) -> FloatArray:
    state = np.random.default_rng(seed).normal(0.0, 0.1, (9, count))
    state[0] += 0.5
    return state


def reference(state: FloatArray, end: float) -> FloatArray:
    solution = solve_ivp(
        lambda _, a: MFE.right_hand_side(a),
        (0.0, end),
        state,
        method="DOP853",
        rtol=1e-13,
        atol=1e-14,
    )
    return np.asarray(solution.y[:, -1])


def test_agrees_with_an_independent_integrator() -> None:
    state = initial_states(1)
    end = integrate(MFE, state, 0.25, 80)[-1, :, 0]
    np.testing.assert_allclose(end, reference(state[:, 0], 20.0), rtol=0, atol=1e-6)


def test_fourth_order() -> None:
    state = initial_states(1)
    exact = reference(state[:, 0], 16.0)
    errors = [
        np.linalg.norm(integrate(MFE, state, 16.0 / steps, steps)[-1, :, 0] - exact)
        for steps in (32, 64, 128)
    ]
    orders = np.log2(errors[:-1]) - np.log2(errors[1:])
    np.testing.assert_allclose(orders, 4.0, atol=0.15)


def test_exact_on_polynomials_of_time_and_one_step_by_hand() -> None:
    # dx/dt = x^2 by the tableau of the classical scheme, written out with rational numbers
    stepped = step(Quadratic(), np.array([[1.0]]), 0.5)[0, 0]
    k1 = 1.0
    k2 = (1.0 + 0.25 * k1) ** 2
    k3 = (1.0 + 0.25 * k2) ** 2
    k4 = (1.0 + 0.5 * k3) ** 2
    assert stepped == pytest.approx(1.0 + 0.5 / 6.0 * (k1 + 2 * k2 + 2 * k3 + k4), rel=1e-15)


@settings(max_examples=25, deadline=None)
@given(count=st.integers(1, 12), tile=st.integers(1, 5), seed=st.integers(0, 1000))
def test_grouping_changes_no_bit(count: int, tile: int, seed: int) -> None:
    state = initial_states(count, seed)
    own_reynolds = np.random.default_rng(seed).uniform(100.0, 2000.0, count)
    controlled = dataclasses.replace(MFE, reynolds=own_reynolds)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(integration, "_TILE", tile)
        together = integrate(MFE, state, 0.25, 12, 4)
        controlled_together = integrate_observed(controlled, state, 0.25, 12, 4, 3)
    for index in range(count):
        one = state[:, index : index + 1]
        assert np.array_equal(together[..., [index]], integrate(MFE, one, 0.25, 12, 4))
        alone = integrate_observed(
            MoehlisFaisstEckhardt(float(own_reynolds[index])), one, 0.25, 12, 4, 3
        )
        assert np.array_equal(controlled_together.states[..., [index]], alone.states)
        assert controlled_together.largest_observable[index] == alone.largest_observable[0]


def test_stride_keeps_every_so_manieth_state() -> None:
    state = initial_states(3)
    every = integrate(MFE, state, 0.25, 11)
    assert every.shape == (12, 9, 3)
    assert np.array_equal(every[0], state)
    assert np.array_equal(every[1], step(MFE, state, 0.25))
    assert np.array_equal(integrate(MFE, state, 0.25, 11, 4), every[:9:4])
    assert np.array_equal(integrate(MFE, state, 0.25, 0), state[np.newaxis])


def test_input_is_left_alone_and_may_have_any_layout() -> None:
    state = initial_states(4)
    before = state.copy()
    result = integrate(MFE, state, 0.25, 3)
    assert np.array_equal(state, before)
    assert np.array_equal(integrate(MFE, np.asfortranarray(state), 0.25, 3), result)


def test_observed_drops_the_transient_and_sees_what_the_stride_misses() -> None:
    system = Lorenz63()
    state = np.array([[1.0, -3.0], [1.0, 4.0], [20.0, 30.0]])
    every = integrate(system, state, 0.02, 160)
    observed = integrate_observed(system, state, 0.02, 100, 50, transient_steps=60)
    assert np.array_equal(observed.states, every[60::50])
    expected = every[60:, 2].max(axis=0)
    assert np.array_equal(observed.largest_observable, expected)
    assert (expected > observed.states[:, 2].max(axis=0)).all()


def test_observed_counts_the_first_state_but_not_the_transient() -> None:
    falling = np.array([[-1.0, -4.0]])  # dx/dt = x^2 rises to 0, so -x falls: watch the first
    observed = integrate_observed(Quadratic(), falling, 0.01, 0)
    assert np.array_equal(observed.largest_observable, [-1.0, -4.0])
    burst = np.eye(9)[:, :1] * 1.2
    watched = integrate_observed(MFE, burst, 0.25, 40, 4, transient_steps=200)
    assert watched.largest_observable[0] < MFE.observable(burst)[0]
    assert watched.largest_observable[0] == MFE.observable(watched.states[0])[0]


def test_blow_up_raises_and_names_the_trajectory() -> None:
    state = np.array([[-1.0, -1.0, 5.0]])
    for function in (integrate, integrate_observed):
        with pytest.raises(FloatingPointError, match="trajectory 2 left the range"):
            function(Quadratic(), state, 0.1, 40)


@dataclass(frozen=True)
class HalfQuadratic(Quadratic):
    """The same beside a component that decays."""

    dimension: ClassVar[int] = 2

    def right_hand_side(self, state: FloatArray) -> FloatArray:
        return np.stack([np.square(state[0]), -state[1]])


def test_one_component_that_blows_up_is_enough() -> None:
    state = np.array([[-1.0, 5.0, -1.0], [1.0, 1.0, 1.0]])
    for function in (integrate, integrate_observed):
        with pytest.raises(FloatingPointError, match="trajectory 1 left the range"):
            function(HalfQuadratic(), state, 0.1, 40)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"state": np.zeros((8, 2))}, r"shape \(9, batch\), not \(8, 2\)"),
        ({"state": np.zeros(9)}, r"shape \(9, batch\), not \(9,\)"),
        ({"state": np.full((9, 1), np.nan)}, "initial state is not finite"),
        ({"time_step": 0.0}, "time step must be positive"),
        ({"time_step": np.inf}, "time step must be positive"),
        ({"steps": -1}, "number of steps must not be negative"),
        ({"stride": 0}, "stride must be at least one"),
        ({"transient_steps": -1}, "transient must not be negative"),
    ],
)
def test_bad_arguments_raise(arguments: dict[str, object], message: str) -> None:
    defaults = {"state": np.zeros((9, 2)), "time_step": 0.25, "steps": 4, "stride": 2}
    with pytest.raises(ValueError, match=message):
        integrate_observed(MFE, **(defaults | arguments))  # type: ignore[arg-type]
    if "transient_steps" not in arguments:
        with pytest.raises(ValueError, match=message):
            integrate(MFE, **(defaults | arguments))  # type: ignore[arg-type]


def test_parameters_of_the_wrong_size_raise() -> None:
    system = dataclasses.replace(MFE, reynolds=np.array([400.0, 500.0, 600.0]))
    with pytest.raises(ValueError, match="broadcast"):
        integrate(system, initial_states(2), 0.25, 1)
