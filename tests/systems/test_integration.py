"""Integration: order, reference solutions, grouping, and integrators of a system's own."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from burstcast.control.actuation import actuated_system
from burstcast.systems import integration
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.check import check_system
from burstcast.systems.compiled import compiled_steps
from burstcast.systems.fitzhugh_nagumo import FitzHughNagumoPair
from burstcast.systems.flow_map import FlowMap
from burstcast.systems.forced import ForcedSystem, forced_system
from burstcast.systems.integration import integrate, integrate_observed
from burstcast.systems.lyapunov import lyapunov_spectrum, perturbation_growth
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.stiff import StiffSystem
from helpers_library import FirstObserved

MFE = MoehlisFaisstEckhardt(400.0)


@dataclass(frozen=True)
class HalfQuadratic(FirstObserved, DynamicalSystem):
    """dx/dt = x^2, infinite in finite time from positive values, beside a decay."""

    dimension: ClassVar[int] = 2

    def right_hand_side(self, state):
        return np.stack([np.square(state[0]), -state[1]])


class NotCompiled(MoehlisFaisstEckhardt):
    def right_hand_side(self, state):
        return super().right_hand_side(np.asarray(state, dtype=np.float64))


def initial_states(count, seed=1):
    state = np.random.default_rng(seed).normal(0.0, 0.1, (9, count))
    state[0] += 0.5
    return state


def scipys(right_hand_side, end, state, method="DOP853", rtol=1e-13, times=None):
    """States of one trajectory by another scheme, ``(component, times)``; the last one without."""
    states_at = solve_ivp(
        lambda _, y: right_hand_side(y), (0.0, end), state, method, times, rtol=rtol, atol=rtol / 10
    ).y
    return states_at[:, -1] if times is None else states_at


def test_fourth_order_towards_what_an_independent_integrator_finds():
    state = initial_states(1)
    exact = scipys(MFE.right_hand_side, 16.0, state[:, 0])
    errors = [
        np.linalg.norm(integrate(MFE, state, 16.0 / steps, steps)[-1, :, 0] - exact)
        for steps in (32, 64, 128)
    ]
    assert errors[1] < 1e-6
    orders = np.log2(errors[:-1]) - np.log2(errors[1:])
    np.testing.assert_allclose(orders, 4.0, atol=0.15)


@settings(max_examples=25)
@given(count=st.integers(1, 12), tile=st.integers(1, 5), seed=st.integers(0, 1000))
def test_grouping_changes_no_bit(count, tile, seed):
    state = initial_states(count, seed)
    by_numpy = NotCompiled(400.0)
    assert compiled_steps((by_numpy,), 0.25, False) is None
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(integration, "_TILE", tile)
        together = integrate_observed(by_numpy, state, 0.25, 12, 4, 3)
        states = integrate(by_numpy, state, 0.25, 12, 4)
    alone = [integrate_observed(MFE, column[:, None], 0.25, 12, 4, 3) for column in state.T]
    assert np.array_equal(states, integrate(MFE, state, 0.25, 12, 4))
    for index, trajectory in enumerate(alone):
        assert np.array_equal(together.states[..., [index]], trajectory.states)
        assert together.largest_observable[index] == trajectory.largest_observable[0]


def test_layout_and_no_steps_change_nothing():
    state = initial_states(4)
    before = state.copy()
    result = integrate(MFE, state, 0.25, 3)
    assert np.array_equal(state, before)
    assert np.array_equal(integrate(MFE, np.asfortranarray(state), 0.25, 3), result)
    assert np.array_equal(integrate(MFE, state, 0.25, 0), state[np.newaxis])


@pytest.mark.parametrize("function", [integrate, integrate_observed])
@pytest.mark.parametrize("lost", [0, 1, 2])
def test_blow_up_raises_and_names_the_trajectory(function, lost):
    # one component is enough
    state = np.array([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]])
    state[0, lost] = 5.0
    with pytest.raises(FloatingPointError, match=f"trajectory {lost} left the range"):
        function(HalfQuadratic(), state, 0.1, 40)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"state": np.zeros((8, 2))}, r"shape \(9, batch\), not \(8, 2\)"),
        ({"state": np.zeros(9)}, r"shape \(9, batch\), not \(9,\)"),
        ({"state": [1.0] * 9}, "must be an array, not list"),
        ({"state": np.full((9, 1), np.nan)}, "initial state is not finite"),
        ({"time_step": 0.0}, "time step must be positive"),
        ({"time_step": np.inf}, "time step must be positive"),
        ({"steps": -1}, "number of steps must not be negative"),
        ({"stride": 0}, "stride must be at least one"),
        ({"transient_steps": -1}, "transient must not be negative"),
    ],
)
def test_bad_arguments_raise(arguments, message):
    defaults = {"state": np.zeros((9, 2)), "time_step": 0.25, "steps": 4, "stride": 2}
    with pytest.raises((TypeError, ValueError), match=message):
        integrate_observed(MFE, **(defaults | arguments))
    if "transient_steps" not in arguments:
        with pytest.raises((TypeError, ValueError), match=message):
            integrate(MFE, **(defaults | arguments))


# -- what is optional ------------------------------------------------------------------------------


@dataclass(frozen=True)
class Henon(FirstObserved, FlowMap):
    a: float = 1.4
    b: float = 0.3

    dimension: ClassVar[int] = 2

    def flow_map(self, state, time_step):
        new = np.empty_like(state)
        new[0] = 1.0 - self.a * state[0] * state[0] + state[1]
        new[1] = self.b * state[0]
        return new

    def sample_initial_states(self, series, generator):
        return np.asarray(generator.uniform(-0.1, 0.1, (2, series)))


@dataclass(frozen=True)
class VanDerPol(FirstObserved, StiffSystem):
    """Relaxation oscillations, for which an explicit scheme needs tiny steps."""

    mu: float = 200.0

    dimension: ClassVar[int] = 2

    def right_hand_side(self, state):
        x, y = state
        return np.stack([y, self.mu * (1.0 - x * x) * y - x])


# -- maps ------------------------------------------------------------------------------------------
def test_a_map_is_iterated_and_checked_like_everything_else():
    assert "its own integrator" in check_system(Henon(), np.random.default_rng(7))
    states = np.array([[0.1, 0.2], [0.1, 0.0]])
    states_at = integrate(Henon(), states, 1.0, 6, stride=2)
    x, y = 0.1, 0.1
    for number in range(1, 7):
        x, y = 1.0 - 1.4 * x * x + y, 0.3 * x
        if number % 2 == 0:
            np.testing.assert_allclose(states_at[number // 2, :, 0], [x, y], rtol=1e-13)
    watched = integrate_observed(Henon(), states, 1.0, 6, 2)
    np.testing.assert_array_equal(watched.states, states_at)


def test_exponents_of_the_henon_map():
    """0.4192 (Sprott, Chaos and Time-Series Analysis, 2003); the sum is log b, exactly."""
    start = integrate(Henon(), np.random.default_rng(0).normal(0, 0.1, (2, 20)), 1.0, 100, 100)[-1]
    spectrum = lyapunov_spectrum(Henon(), start, 1.0, 3000, 5, alignment_steps=50).exponents
    np.testing.assert_allclose(spectrum.sum(axis=1), math.log(0.3), rtol=1e-9)
    assert spectrum[:, 0].mean() == pytest.approx(0.4192, abs=0.005)
    growth = perturbation_growth(
        Henon(), start, 1.0, 3000, 1e-9, 1e-4, np.random.default_rng(1), alignment_steps=50
    )
    assert growth.mean() == pytest.approx(0.4192, abs=0.005)


def test_what_needs_a_right_hand_side_says_so():
    with pytest.raises(ValueError, match="Henon advances by a map and has no right-hand side"):
        Henon().right_hand_side(np.zeros((2, 1)))
    with pytest.raises(ValueError, match=r"force.*Henon has an integrator of its own"):
        actuated_system(Henon(), {}, [0.1, 0.0])
    assert actuated_system(Henon(), {"a": 1.2}) == Henon(a=1.2)


# -- stiff systems ---------------------------------------------------------------------------------
def test_a_stiff_system_against_scipy_by_another_scheme():
    system = VanDerPol()
    states = np.array([[2.0, -1.5], [0.0, 0.3]])
    states_at = integrate(system, states, 5.0, 4, stride=2)
    for number, start in enumerate(states.T):
        expected = scipys(system.right_hand_side, 20.0, start, "BDF", 1e-11, [0.0, 10.0, 20.0])
        np.testing.assert_allclose(states_at[:, :, number], expected.T, rtol=1e-5, atol=1e-7)
        alone = integrate(system, states[:, [number]], 5.0, 4, stride=2)
        np.testing.assert_array_equal(states_at[..., [number]], alone)


# -- a force under integrators of the system's own -------------------------------------------------
def test_a_force_on_a_stiff_system_against_scipy():
    system, force, start = VanDerPol(), np.array([2.0, -1.0]), np.array([1.0, 0.2])
    states_at, free = (
        integrate(trajectory, start[:, np.newaxis], 1.0, 2, 2)[-1, :, 0]
        for trajectory in (actuated_system(system, {}, list(force)), system)
    )
    expected = scipys(lambda y: system.right_hand_side(y) + force, 2.0, start, "LSODA", 1e-10)
    np.testing.assert_allclose(states_at, expected, rtol=1e-5, atol=1e-7)
    assert not np.allclose(states_at, free, atol=1e-3)


def test_a_forced_stiff_system_keeps_its_scheme():
    class Coarse(VanDerPol):
        method = "LSODA"
        relative_tolerance, absolute_tolerance = 1e-3, 1e-4

    start = np.array([[1.0, -2.0], [0.5, 0.0]])
    states_at = integrate(actuated_system(Coarse(), {}, [0.0, 0.0]), start, 0.5, 1)
    # but for rounding: its Jacobian is found by complex steps
    np.testing.assert_allclose(states_at, integrate(Coarse(), start, 0.5, 1), rtol=1e-9)
    assert not np.allclose(states_at, integrate(VanDerPol(), start, 0.5, 1), rtol=1e-7)


def test_a_force_is_refused_where_a_class_replaces_the_scheme():
    class Frozen(VanDerPol):
        def flow_map(self, state, time_step):
            return state

    for make in (ForcedSystem, forced_system):
        with pytest.raises(ValueError, match="Frozen has an integrator of its own"):
            make(Frozen(), [1.0, 0.0])
    with pytest.raises(ValueError, match="VanDerPol has an integrator of its own"):
        ForcedSystem(VanDerPol(), [1.0, 0.0])  # of the Runge-Kutta scheme


# -- the pair of FitzHugh-Nagumo units -------------------------------------------------------------
def test_the_equations_of_the_pair():
    """Against the equations unit by unit."""
    a, b, c, k = -0.025794, (0.0065, 0.0135), 0.02, 0.128
    state = np.random.default_rng(5).normal(0.0, 0.4, (4, 5))
    states_at = FitzHughNagumoPair().right_hand_side(state)
    for i in range(2):
        x, y, other = state[i], state[2 + i], state[1 - i]
        np.testing.assert_allclose(states_at[i], x * (a - x) * (x - 1) - y + k * (other - x))
        np.testing.assert_allclose(states_at[2 + i], b[i] * x - c * y)
