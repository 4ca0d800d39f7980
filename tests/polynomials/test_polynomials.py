"""Monomials, regression in integral form and polynomial systems, piece by piece."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.preprocessing import PolynomialFeatures

from burstcast.polynomials.basis import denoised, monomials
from burstcast.polynomials.regression import gregory_weights, polynomial_coefficients
from burstcast.polynomials.system import PolynomialSystem
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63


@given(dimension=st.integers(1, 5), degree=st.integers(1, 3))
def test_monomials_without_noise_are_those_of_scikit_learn(dimension, degree):
    states = np.random.default_rng(1).normal(size=(7, dimension))
    values = denoised(states, np.zeros(dimension), monomials(dimension, degree))
    expected = PolynomialFeatures(degree).fit_transform(states)
    np.testing.assert_allclose(values.T, expected, rtol=1e-12)


def test_noise_leaves_the_mean_of_the_monomials_as_it_is():
    state, deviation = np.array([0.7, -1.3]), np.array([0.5, 0.8])
    # exact means over Gaussian noise, by quadrature
    nodes, weights = np.polynomial.hermite_e.hermegauss(12)
    weights = weights / weights.sum()
    first, second = np.meshgrid(nodes, nodes, indexing="ij")
    observed = state + deviation * np.stack([first, second], axis=-1)
    basis = monomials(2, 3)
    means = np.einsum("mij,i,j->m", denoised(observed, deviation**2, basis), weights, weights)
    expected = [math.prod(state[list(factors)]) for factors in basis]
    np.testing.assert_allclose(means, expected, atol=1e-12)


@given(intervals=st.integers(1, 40))
def test_quadrature_is_exact_for_polynomials(intervals):
    weights = gregory_weights(intervals)
    points = np.arange(intervals + 1) / intervals
    corrections = min(5, (intervals + 1) // 2)
    for power in range(corrections + 1):
        integral = weights @ points**power / intervals
        assert integral == pytest.approx(1 / (power + 1), rel=1e-10)


def test_coefficients_are_those_of_least_squares():
    """All terms kept: numpy's least squares of increments on integrals, window by window."""
    series = np.random.default_rng(5).standard_normal((3, 80, 2)).cumsum(axis=1)
    basis, weights = monomials(2, 2), gregory_weights(6)
    integrals, increments = [], []
    for states in series:
        values = np.array([np.prod(states[:, list(factors)], axis=1) for factors in basis])
        for start in range(80 - 6):
            integrals.append(0.5 * values[:, start : start + 7] @ weights)
            increments.append(states[start + 6] - states[start])
    expected = np.linalg.lstsq(np.array(integrals), np.array(increments))[0]
    found = polynomial_coefficients(series, np.zeros(2), 0.5, 2, 6, 0.0)
    np.testing.assert_allclose(found, expected, rtol=1e-6)


def test_noise_biases_no_coefficient():
    """dx/dt = 3 - x^2 from many starts, with noise of a fifth of the standard deviation."""
    system = PolynomialSystem(np.array([[3.0], [0.0], [-1.0]]), 2, Lorenz63())
    start = np.linspace(-1.0, 2.5, 2000)[np.newaxis]
    true = integrate(system, start, 0.05, 30).transpose(2, 0, 1)
    deviation = 0.2 * true.std(axis=(0, 1))
    observed = true + deviation * np.random.default_rng(9).standard_normal(true.shape)
    corrected, plain = (
        polynomial_coefficients(observed, known, 0.05, 2, 10, 4.0)
        for known in (deviation, 0 * deviation)
    )
    np.testing.assert_allclose(corrected[:, 0], [3.0, 0.0, -1.0], atol=0.01)
    assert np.abs(plain[:, 0] - [3.0, 0.0, -1.0]).max() > 0.1


def test_too_few_series_are_refused():
    with pytest.raises(ValueError, match="too few for 55 coefficients"):
        polynomial_coefficients(np.zeros((2, 30, 9)), np.zeros(9), 1.0, 2, 12, 4.0)
    series = np.random.default_rng(1).normal(size=(2, 300, 3))
    series[:, :, 1] = 2.0
    with pytest.raises(ValueError, match="component 2 is constant"):
        polynomial_coefficients(series, np.zeros(3), 1.0, 2, 12, 4.0)


@pytest.fixture
def cubic():
    generator = np.random.default_rng(6)
    coefficients = generator.normal(size=(20, 3)) * (generator.random((20, 3)) < 0.5)
    return PolynomialSystem(coefficients, 3, Lorenz63()), coefficients


def test_a_polynomial_system_is_the_sum_of_its_terms(cubic):
    system, coefficients = cubic
    states = np.random.default_rng(7).normal(size=(3, 4, 5))
    features = PolynomialFeatures(3).fit_transform(states.reshape(3, -1).T)
    expected = (features @ coefficients).T.reshape(states.shape)
    np.testing.assert_allclose(system.right_hand_side(states), expected, rtol=1e-12, atol=1e-12)
    assert system.dimension == 3
    np.testing.assert_array_equal(system.observable(states), Lorenz63().observable(states))


def test_the_jacobian_is_that_of_finite_differences(cubic):
    system, _ = cubic
    states = np.random.default_rng(8).normal(size=(3, 6))
    for component in range(3):
        step = 1e-6 * (np.arange(3) == component)[:, np.newaxis]
        difference = system.right_hand_side(states + step) - system.right_hand_side(states - step)
        np.testing.assert_allclose(
            system.jacobian(states)[:, component], difference / 2e-6, rtol=1e-6, atol=1e-7
        )


def test_batches_do_not_matter(cubic):
    system, _ = cubic
    states = 0.1 * np.random.default_rng(9).normal(size=(3, 37))
    together = integrate(system, states, 0.01, 20)
    for first, last in ((0, 1), (1, 8), (8, 37)):
        np.testing.assert_array_equal(
            integrate(system, states[:, first:last], 0.01, 20), together[..., first:last]
        )


def test_coefficients_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match="have 10 coefficients, not 9"):
        PolynomialSystem(np.zeros((9, 3)), 2, Lorenz63())
