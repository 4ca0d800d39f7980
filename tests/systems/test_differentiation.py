"""Derivatives of right-hand sides that give no Jacobian."""

from typing import ClassVar

import numpy as np
import pytest

from burstcast.systems.base import DynamicalSystem, has_own
from burstcast.systems.compiled import compiled_steps
from burstcast.systems.differentiation import derivative, derivative_method, jacobian
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.lyapunov import tangent_flow, with_perturbations
from helpers_library import FirstObserved

STATES = np.random.default_rng(3).normal(0.0, 8.0, (3, 6))


class LorenzWithoutJacobian(FirstObserved, DynamicalSystem):
    dimension: ClassVar[int] = 3

    def right_hand_side(self, state):
        return Lorenz63().right_hand_side(state)


class LorenzOfRealNumbers(LorenzWithoutJacobian):
    """Its results are put into real arrays: a complex step would find no derivative."""

    def right_hand_side(self, state):
        derivative = np.zeros(state.shape)
        derivative[:] = Lorenz63().right_hand_side(np.real(state))
        return derivative


@pytest.mark.parametrize(
    ("system", "method", "accuracy"),
    [
        (LorenzWithoutJacobian(), "complex step", 1e-14),
        (LorenzOfRealNumbers(), "finite differences", 1e-8),
    ],
)
def test_the_jacobian_is_found_where_it_is_not_given(system, method, accuracy):
    assert derivative_method(system.right_hand_side, 3) == method
    assert not has_own(system, "jacobian")
    expected = Lorenz63().jacobian(STATES)
    np.testing.assert_allclose(system.jacobian(STATES), expected, atol=30 * accuracy)
    derivatives = jacobian(system.right_hand_side, STATES, method)
    np.testing.assert_array_equal(derivatives, system.jacobian(STATES))


def test_absolute_values_are_not_differentiated_by_complex_steps():
    def folded(state):
        return np.asarray(np.abs(state) * state)  # its derivative is 2 abs(x)

    assert derivative_method(folded, 2) == "finite differences"
    states = np.array([[1.0, -2.0], [-0.5, 3.0]])
    derivatives = jacobian(folded, states, "finite differences")
    np.testing.assert_allclose(derivatives[0, 0], 2.0 * np.abs(states[0]), rtol=1e-8)
    np.testing.assert_allclose(derivatives[0, 1], 0.0, atol=1e-8)


def test_a_derivative_along_nothing_is_nothing():
    for method in ("complex step", "finite differences"):
        function = Lorenz63().right_hand_side
        assert not derivative(function, STATES, np.zeros_like(STATES), method).any()


def test_states_with_perturbations_are_those_without_bit_for_bit():
    tangent = np.random.default_rng(4).normal(size=(3, 2, 6))
    _, expected = with_perturbations(Lorenz63(), STATES, tangent, 0.01, 7)
    for system in (LorenzWithoutJacobian(), LorenzOfRealNumbers(), Lorenz63()):
        states, grown = with_perturbations(system, STATES, tangent, 0.01, 7)
        np.testing.assert_array_equal(states, integrate(system, STATES, 0.01, 7, 7)[-1])
        np.testing.assert_allclose(grown, expected, rtol=0, atol=1e-6)


def test_what_is_compiled_with_a_jacobian_is_not_without_and_as_right():
    assert compiled_steps((tangent_flow(Lorenz63()),), 0.01, False) is not None
    assert compiled_steps((tangent_flow(LorenzWithoutJacobian()),), 0.01, False) is None
    assert compiled_steps((LorenzWithoutJacobian(),), 0.01, False) is not None
