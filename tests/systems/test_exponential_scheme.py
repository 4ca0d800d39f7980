"""The exponential scheme: its order, stiffness, and a force that it integrates."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from burstcast.control.actuation import ActuatorShare, actuated_system, reversed_actuation
from burstcast.systems.exponential_scheme import SemilinearSystem
from burstcast.systems.integration import integrate
from helpers_library import FirstObserved


@dataclass(frozen=True)
class DampedTriad(FirstObserved, SemilinearSystem):
    """Three modes that exchange energy, two of them damped, one strongly."""

    damping: float = 400.0

    dimension: ClassVar[int] = 3

    def linear_rates(self):
        return np.array([0.3, -1.0, -self.damping])

    def nonlinear(self, state):
        x, y, z = state
        return np.stack([y * z - x * x * x, x * z + x, -2.0 * x * y])


def scipys(right_hand_side, end, state, method, tolerance):
    """Last state of one trajectory by another scheme."""
    return solve_ivp(
        lambda _, y: right_hand_side(y),
        (0.0, end),
        state,
        method,
        rtol=tolerance,
        atol=tolerance / 10,
    ).y[:, -1]


def errors_of(system, steps):
    """Errors after two time units, in so many steps."""
    start = np.array([[0.5], [0.2], [0.1]])
    expected = scipys(system.right_hand_side, 2.0, start[:, 0], "Radau", 1e-12)
    return [
        float(np.abs(integrate(system, start, 2 / n, n, n)[-1, :, 0] - expected).max())
        for n in steps
    ]


def test_the_exponential_scheme_is_of_fourth_order_and_bears_stiffness():
    coarse, fine = errors_of(DampedTriad(damping=2.0), (40, 80))
    assert coarse < 1e-6
    assert coarse / fine == pytest.approx(16, rel=0.2)
    # steps twenty times as long as those at which the Runge-Kutta scheme explodes
    coarse, fine = errors_of(DampedTriad(damping=400.0), (20, 160))
    assert coarse < 1e-2
    assert fine < coarse / 20


def test_the_exponential_scheme_is_exact_where_all_is_linear():
    class Decay(DampedTriad):
        def nonlinear(self, state):
            return np.zeros_like(state)

    start = np.array([[1.0], [2.0], [3.0]])
    states = integrate(Decay(), start, 0.5, 1)[-1]
    np.testing.assert_allclose(states[:, 0], start[:, 0] * np.exp([0.15, -0.5, -200.0]), rtol=1e-13)


# -- a force ---------------------------------------------------------------------------------------
def test_a_force_on_a_semilinear_system_is_the_same_by_each_way_to_it():
    start, system = np.random.default_rng(6).normal(size=(3, 5)), DampedTriad()
    share = ActuatorShare.of(system, {}, [0.0, 0.0, 300.0])
    states = [
        integrate(forced, start, 0.02, 40, 40)
        for forced in (
            actuated_system(system, {}, [0.0, 0.0, 150.0]),
            actuated_system(system, {}, [0.0, 0.0, 300.0], strength=0.5),
            share.system([0.5]),
            reversed_actuation(system, [0.0, 0.0, -300.0], 0.5),
        )
    ]
    for other in states[1:]:
        np.testing.assert_array_equal(other, states[0])


def test_a_force_against_scipy():
    system, force, start = DampedTriad(), np.array([2.0, 0.5, -1.0]), np.array([1.0, 0.6, 0.2])
    states, free = (
        integrate(equations, start[:, np.newaxis], 0.005, 400, 400)[-1, :, 0]
        for equations in (actuated_system(system, {}, list(force)), system)
    )
    expected = scipys(lambda y: system.right_hand_side(y) + force, 2.0, start, "LSODA", 1e-10)
    np.testing.assert_allclose(states, expected, rtol=1e-5, atol=1e-7)
    assert not np.allclose(states, free, atol=1e-3)
