"""The Lorenz equations against their textbook form and known properties."""

import math

import numpy as np
import pytest

from burstcast.systems.lorenz63 import Lorenz63


def test_textbook_values() -> None:
    state = np.array([1.0, 2.0, 3.0])
    derivative = Lorenz63(sigma=10.0, rho=28.0, beta=2.0).right_hand_side(state)
    assert np.array_equal(derivative, [10.0, 23.0, -4.0])


def test_fixed_points() -> None:
    system = Lorenz63()
    distance = math.sqrt(system.beta * (system.rho - 1.0))
    points = np.array([[0, distance, -distance], [0, distance, -distance], [0, 27.0, 27.0]])
    np.testing.assert_allclose(system.right_hand_side(points), 0.0, atol=1e-13)


def test_jacobian_is_the_complex_step_derivative() -> None:
    system = Lorenz63(9.0, 20.0, 2.5)
    state = np.random.default_rng(1).normal(0, 10, (3, 8))
    for j in range(3):
        perturbed = state.astype(complex)
        perturbed[j] += 1e-30j
        column = system.right_hand_side(perturbed).imag / 1e-30
        np.testing.assert_allclose(system.jacobian(state)[:, j], column, rtol=0, atol=1e-13)


def test_observable_is_a_copy_of_z() -> None:
    state = np.arange(6.0).reshape(3, 2)
    observed = Lorenz63().observable(state)
    assert np.array_equal(observed, [4.0, 5.0])
    observed[:] = 0.0
    assert np.array_equal(state[2], [4.0, 5.0])


def test_series_of_an_ensemble_begin_apart_and_cover_many_turns() -> None:
    ensemble = Lorenz63.case_defaults["ensemble"]
    assert ensemble["initial_state"][ensemble["perturbed_component"] - 1] == 20.0
    # starts are spread over a tenth of what z covers, 1 to 48
    assert ensemble["perturbation"] == 5.0
    assert ensemble["time_step"] * ensemble["sampling_stride"] == 0.02
    assert (ensemble["transient"], ensemble["duration"]) == (20.0, 80.0)
    # z is positive; its fixed points with lobes around them are at rho - 1, that below at 0
    assert Lorenz63.case_defaults["density"]["range"] == [0.0, 50.0]
    assert Lorenz63.case_defaults["fixed_point"] == {"variation": 0.1, "above": 0.0}


@pytest.mark.parametrize("name", ["sigma", "rho", "beta"])
def test_bad_parameters_raise(name: str) -> None:
    with pytest.raises(ValueError, match=f"{name} must be finite"):
        Lorenz63(**{name: math.nan})
