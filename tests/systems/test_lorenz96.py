"""The Lorenz 96 model: its budget and its symmetry."""

import dataclasses

import numpy as np
import pytest

from burstcast.systems.integration import integrate
from burstcast.systems.lorenz96 import Lorenz96
from burstcast.systems.registry import make_system, parameters_of

STATES = np.random.default_rng(4).normal(3.0, 4.0, (11, 6))
SYSTEM = Lorenz96(forcing=7.5, variables=11)


def test_advection_keeps_the_energy_and_the_budget_is_closed():
    energy_rate = (STATES * SYSTEM.right_hand_side(STATES)).sum(axis=0)
    budget = SYSTEM.energy_budget(STATES)
    np.testing.assert_allclose(budget.input - budget.dissipation, energy_rate, rtol=1e-11)
    np.testing.assert_allclose(budget.input, 7.5 * STATES.sum(axis=0), rtol=1e-12)
    np.testing.assert_allclose(2 * 11 * SYSTEM.observable(STATES), budget.dissipation, rtol=1e-12)
    # volumes shrink at the rate of the damping
    np.testing.assert_allclose(np.trace(SYSTEM.jacobian(STATES)), -11.0)


def test_a_shifted_solution_is_a_solution():
    (shift,) = SYSTEM.symmetries()
    moved = shift.transform(STATES)
    assert shift.order == 11
    assert not np.array_equal(moved, STATES)
    assert np.array_equal(
        integrate(SYSTEM, moved, 0.01, 50)[-1],
        shift.transform(integrate(SYSTEM, STATES, 0.01, 50)[-1]),
    )


def test_parameters():
    assert make_system("lorenz96", {}) == Lorenz96(8.0, 40)
    system = make_system("lorenz96", {"variables": 10.0, "forcing": 9})
    assert parameters_of(system) == {"forcing": 9.0, "variables": 10}
    assert system.dimension == len(system.component_names) == 10
    for name, value, message in (("variables", 3, "4 at least"), ("forcing", np.inf, "finite")):
        with pytest.raises(ValueError, match=f"{name} must be {message}"):
            dataclasses.replace(SYSTEM, **{name: value})
