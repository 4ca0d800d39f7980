"""Monomials, regression in integral form and polynomial systems, piece by piece."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.preprocessing import PolynomialFeatures

from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.polynomials.basis import denoised, monomials
from burstcast.systems.polynomials.regression import (
    _changes_of_form,
    _conserving,
    _moments,
    factored_coefficients,
    gregory_weights,
)
from burstcast.systems.polynomials.system import PolynomialSystem
from helpers_library import lorenz_series


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


def test_noise_biases_no_coefficient():
    """dx/dt = 3 - x^2 from many starts, with noise of a fifth of the standard deviation."""
    system = PolynomialSystem(np.array([[3.0], [0.0], [-1.0]]), 2, Lorenz63())
    start = np.linspace(-1.0, 2.5, 2000)[np.newaxis]
    true = integrate(system, start, 0.05, 30).transpose(2, 0, 1)
    deviation = 0.2 * true.std(axis=(0, 1))
    observed = true + deviation * np.random.default_rng(9).standard_normal(true.shape)
    corrected, plain = (
        factored_coefficients(observed, noise_deviation, 0.05, 2, 10, 4.0)[0]
        for noise_deviation in (deviation, 0 * deviation)
    )
    np.testing.assert_allclose(corrected[:, 0], [3.0, 0.0, -1.0], atol=0.01)
    assert np.abs(plain[:, 0] - [3.0, 0.0, -1.0]).max() > 0.1


def test_a_polynomial_system_is_the_sum_of_its_terms():
    generator = np.random.default_rng(6)
    coefficients = generator.normal(size=(20, 3)) * (generator.random((20, 3)) < 0.5)
    system, states = PolynomialSystem(coefficients, 3, Lorenz63()), generator.normal(size=(3, 4, 5))
    features = PolynomialFeatures(3).fit_transform(states.reshape(3, -1).T)
    expected = (features @ coefficients).T.reshape(states.shape)
    np.testing.assert_allclose(system.right_hand_side(states), expected, rtol=1e-12, atol=1e-12)
    assert system.dimension == 3
    np.testing.assert_array_equal(system.observable(states), Lorenz63().observable(states))
    with pytest.raises(ValueError, match="have 20 coefficients, not 19"):
        PolynomialSystem(coefficients[1:], 3, Lorenz63())


def switching_factors(series, time, count, generator):
    """Factors that change at random steps."""
    values = generator.normal(size=(3, count))
    changes = generator.random((series, time - 1)) < 0.06
    return values[np.cumsum(changes, axis=1) % 3]


@pytest.mark.parametrize("count", [0, 1, 2])
def test_factored_coefficients_are_those_of_least_squares(count):
    """Numpy's least squares of increments on [integrals, q integrals, ...], window by window."""
    generator = np.random.default_rng(8)
    series = generator.standard_normal((3, 200, 2)).cumsum(axis=1)
    factors = switching_factors(3, 200, count, generator)
    basis, weights = monomials(2, 2), gregory_weights(6)
    rows, increments = [], []
    for states, of_series in zip(series, factors, strict=True):
        values = np.array([np.prod(states[:, list(factors_of)], axis=1) for factors_of in basis])
        for start in range(200 - 6):
            inside = of_series[start : start + 6]
            if (inside == inside[0]).all():
                integral = 0.5 * values[:, start : start + 7] @ weights
                rows.append(np.concatenate([integral, *(q * integral for q in inside[0])]))
                increments.append(states[start + 6] - states[start])
    assert len(rows) == 3 * 194 if count == 0 else 100 < len(rows) < 3 * 194
    expected = np.linalg.lstsq(np.array(rows), np.array(increments))[0]
    coefficients = factored_coefficients(series, np.zeros(2), 0.5, 2, 6, 0.0, factors)
    np.testing.assert_allclose(coefficients.reshape(-1, 2), expected, rtol=1e-6, atol=1e-9)


def test_the_noise_of_factored_moments_is_taken_out():
    """Gram matrices and products of noisy series have the means of the true ones."""
    generator = np.random.default_rng(9)
    true = generator.standard_normal((1, 120, 2)).cumsum(axis=1) / 4
    factors = switching_factors(1, 120, 1, generator)
    deviation = np.array([0.3, 0.5])

    def moments(series, noise):
        return _moments([(series[0], factors[0])], noise, 2, 5)

    exact = moments(true, np.zeros(2))
    noisy = [
        moments(true + deviation * generator.standard_normal(true.shape), deviation)
        for _ in range(600)
    ]
    for expected, *samples in zip(exact, *noisy, strict=True):
        samples = np.array(samples)
        error = samples.std(axis=0) / math.sqrt(len(samples))
        assert (np.abs(samples.mean(axis=0) - expected) <= 5 * error + 1e-9).all()


@pytest.mark.parametrize("value", [-0.4, 0.7])
def test_without_factors_the_equations_are_the_plain_ones(value):
    """No factor: bit for bit. A constant one: its terms cannot be told apart, their sum can."""
    series = lorenz_series(4, 200, 601)
    noise = np.full(3, 1e-3)
    plain = factored_coefficients(series, noise, 0.02, 2, 5, 4.0)[0]
    none = factored_coefficients(series, noise, 0.02, 2, 5, 4.0, np.empty((4, 400, 0)))
    assert np.array_equal(none[0], plain)
    whole = factored_coefficients(series, noise, 0.02, 2, 5, 0.0)[0]
    constant = np.full((4, 400, 1), value)
    coefficients = factored_coefficients(series, noise, 0.02, 2, 5, 0.0, constant)
    np.testing.assert_allclose(
        coefficients[0] + value * coefficients[1], whole, rtol=1e-5, atol=1e-6
    )


TURNED = np.array([[1.0, 0.4, 0.0], [-0.3, 1.0, 0.2], [0.1, 0.5, 1.0]])
"""Other variables of Lorenz's equations, whose quadratic terms conserve x^2 + y^2 + z^2."""


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_quadratic_terms_that_conserve_a_form_are_nearer_to_the_true_ones(noise):
    clean = lorenz_series(4, 50, 900) @ TURNED.T
    deviation = noise * clean.std(axis=(0, 1))
    series = clean + deviation * np.random.default_rng(3).standard_normal(clean.shape)
    inverse = np.linalg.inv(TURNED)
    form = inverse.T @ inverse
    arguments = (series, deviation, 0.02, 2, 5, 0.0)
    free = factored_coefficients(*arguments)[0]
    conserving = factored_coefficients(*arguments, conserved=form)[0]
    states = np.random.default_rng(4).normal(size=(3, 50))

    def change(coefficients):
        quadratic = np.where(np.arange(10)[:, np.newaxis] < 4, 0.0, coefficients)
        system = PolynomialSystem(quadratic, 2, Lorenz63())
        return np.sum(states * (form @ system.right_hand_side(states)), axis=0)

    assert np.abs(change(conserving)).max() < 1e-9
    assert np.abs(change(free)).max() > (1e-4 if noise else 1e-7)

    def lorenz(states):
        return TURNED @ Lorenz63().right_hand_side(inverse @ states)

    wrong = [
        np.square(
            PolynomialSystem(each, 2, Lorenz63()).right_hand_side(20 * states) - lorenz(20 * states)
        ).mean()
        for each in (conserving, free)
    ]
    assert wrong[0] < wrong[1]
    with pytest.raises(ValueError, match="of degree 2 without factors"):
        factored_coefficients(*arguments, np.zeros((4, 899, 1)), conserved=form)


def test_terms_that_conserve_a_form_are_least_squares_under_a_constraint():
    """Equations with equal errors: the nearest coefficients by a penalty that tends to infinity."""
    generator = np.random.default_rng(5)
    states = generator.normal(size=(1, 400, 2))
    form = np.array([[2.0, 0.3], [0.3, 1.0]])
    values = denoised(states[0], np.zeros(2), monomials(2, 2))
    noise = generator.normal(size=(400, 2))
    targets = values.T @ generator.normal(size=(6, 2)) + noise
    gram = np.array([values[:, part] @ values[:, part].T for part in np.split(np.arange(400), 4)])
    cross = np.array([values[:, part] @ targets[part] for part in np.split(np.arange(400), 4)])
    cross[:, :, 1] = cross[:, :, 0] * 0.5  # errors of known proportion
    found = _conserving(np.ones((6, 2)), gram, cross, form)
    constraint = _changes_of_form(form).reshape(4, 12)
    matrix = np.kron(gram.sum(axis=0), np.diag([1.0, 4.0]))
    target = (cross.sum(axis=0) * [1.0, 4.0]).reshape(12)
    penalised = np.linalg.solve(matrix + 1e9 * constraint.T @ constraint, target)
    np.testing.assert_allclose(found.reshape(12), penalised, rtol=1e-4, atol=1e-6)


SERIES = np.random.default_rng(1).normal(size=(2, 300, 3))
CONSTANT = SERIES * [1.0, 0.0, 1.0] + [0.0, 2.0, 0.0]


@pytest.mark.parametrize(
    ("series", "factors", "message"),
    [
        (np.zeros((2, 30, 9)), np.zeros((2, 29, 0)), "too few for 55 coefficients"),
        (CONSTANT, SERIES[:, 1:, :0], "component 1 is constant"),
        (SERIES, SERIES[..., :1], r"factors of the shape \(2, 299, factors\)"),
        (SERIES, SERIES[:, 1:, :1], "too few for 20 coefficients"),
    ],
)
def test_too_few_constant_or_restless_series_are_refused(series, factors, message):
    with pytest.raises(ValueError, match=message):
        factored_coefficients(series, np.zeros(series.shape[2]), 1.0, 2, 12, 0.0, factors)


@pytest.mark.parametrize("centre", [(1e4, -3e5, 2e6), (0.0, 1e5, 0.0)])
def test_the_zero_of_a_unit_does_not_matter(centre):
    """The vector field on the attractor is the same, whatever offset the components have."""
    series = lorenz_series(6, 200, 601)
    noise = np.zeros(3)
    plain = factored_coefficients(series, noise, 0.02, 2, 8, 4.0)[0]
    moved = factored_coefficients(series + np.array(centre), noise, 0.02, 2, 8, 4.0)[0]
    states = series[:, ::50].reshape(-1, 3).T
    rates = PolynomialSystem(plain, 2, Lorenz63()).right_hand_side(states)
    shifted = states + np.array(centre)[:, np.newaxis]
    coefficients = PolynomialSystem(moved, 2, Lorenz63()).right_hand_side(shifted)
    np.testing.assert_allclose(coefficients, rates, atol=1e-2 * np.abs(rates).max())


@pytest.mark.parametrize("kind", ["sine", "white noise"])
def test_noise_beyond_the_trajectory_is_refused_by_component(kind):
    """Its squares are then less than nothing, which the regression cannot divide by."""
    time = np.arange(600)
    series = np.stack([np.sin(0.1 * time), np.sin(2 * np.pi * (time + 0.3) / 4.05)], axis=1)
    if kind == "white noise":
        series[:, 1] = np.random.default_rng(1).standard_normal(600)
    noise = np.array([0.0, 1.5])
    with pytest.raises(ValueError, match=r"component 1, .* sampling is too coarse"):
        factored_coefficients(series[np.newaxis], noise, 1.0, 2, 3, 4.0)
