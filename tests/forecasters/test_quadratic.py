"""Learnt polynomial equations against the equations that the series were made with."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.quadratic import QuadraticModel
from burstcast.polynomials.basis import monomials
from burstcast.polynomials.system import PolynomialSystem
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.mfe import MoehlisFaisstEckhardt

OPTIONS = {"noise": None, "degree": 2, "window_lt": 0.2, "significance": 4.0}
LORENZ = ForecastingCase(Lorenz63(), 0.01, 1, 60, OPTIONS)
FLOW = ForecastingCase(MoehlisFaisstEckhardt(reynolds=400.0), 0.25, 4, 61, OPTIONS)


def lorenz_series(series=4, samples=2000):
    start = np.random.default_rng(3).normal(size=(3, series)) + np.array([[1.0], [1.0], [25.0]])
    return integrate(LORENZ.system, start, 0.01, samples + 500)[500:].transpose(2, 0, 1)


@pytest.fixture(scope="module")
def flow_series():
    """Ten series of the turbulent shear flow, (10, 2000, 9), none of which has laminarised."""
    start = np.array([1, 0, 0.07066, -0.07076, 0, 0, 0, 0, 0])[:, np.newaxis]
    perturbed = (
        start + 0.01 * np.random.default_rng(2).random((9, 40)) * (np.arange(9) == 3)[:, None]
    )
    series = integrate(FLOW.system, perturbed, 0.25, 4 * 2200, stride=4)[200:].transpose(2, 0, 1)
    turbulent = FLOW.system.observable(series.transpose(2, 0, 1)).max(axis=1) < 0.48
    return series[turbulent][:10]


def field_error(model, truth, states):
    learnt, true = model.system.right_hand_side(states.T), truth.right_hand_side(states.T)
    spread = true - true.mean(axis=1, keepdims=True)
    return np.sqrt(np.square(learnt - true).sum() / np.square(spread).sum())


def noisy(series, noise, seed=7):
    deviation = np.random.default_rng(seed).standard_normal(series.shape)
    return series + noise * series.std(axis=(0, 1)) * deviation


def test_the_equations_of_lorenz_are_found_in_clean_series():
    model = QuadraticModel.fit(lorenz_series(), LORENZ)
    sigma, rho, beta = 10.0, 28.0, 8.0 / 3.0
    basis = monomials(3, 2)
    expected = np.zeros((len(basis), 3))
    expected[basis.index((0,))] = [-sigma, rho, 0]
    expected[basis.index((1,))] = [sigma, -1, 0]
    expected[basis.index((2,))] = [0, 0, -beta]
    expected[basis.index((0, 2)), 1] = -1
    expected[basis.index((0, 1)), 2] = 1
    np.testing.assert_allclose(model.coefficients, expected, atol=2e-3)
    np.testing.assert_array_equal(model.coefficients[expected != 0] != 0, True)


def test_the_equations_of_the_shear_flow_are_found_in_clean_series(flow_series):
    model = QuadraticModel.fit(flow_series, FLOW)
    assert field_error(model, FLOW.system, flow_series[0]) < 5e-6


@pytest.mark.parametrize(("noise", "error"), [(0.001, 2e-4), (0.01, 2e-3), (0.05, 1e-2)])
def test_the_error_of_the_field_is_a_fraction_of_the_noise(noise, error, flow_series):
    model = QuadraticModel.fit(noisy(flow_series, noise), FLOW)
    assert field_error(model, FLOW.system, flow_series[0]) < error


def test_insignificant_terms_are_left_out_and_no_others(flow_series):
    model = QuadraticModel.fit(noisy(flow_series, 0.01), FLOW)
    # each coefficient of the true equations, from their second differences at random states
    states = np.random.default_rng(4).normal(size=(9, 400))
    basis = monomials(9, 2)
    values = np.array([np.prod(states[list(factors)], axis=0) for factors in basis])
    true = np.linalg.lstsq(values.T, FLOW.system.right_hand_side(states).T)[0]
    missing = (np.abs(true) > 1e-9) & (model.coefficients == 0)
    superfluous = (np.abs(true) < 1e-9) & (model.coefficients != 0)
    assert not missing.any()
    assert superfluous.sum() <= 2
    everything = QuadraticModel.fit(
        noisy(flow_series, 0.01),
        ForecastingCase(**{**vars(FLOW), "options": {**OPTIONS, "significance": 0.0}}),
    )
    assert (everything.coefficients != 0).all()
    errors = [field_error(one, FLOW.system, flow_series[1]) for one in (model, everything)]
    assert errors[0] < 0.6 * errors[1]


def test_the_learnt_equations_are_integrated_as_scipy_does_it():
    model = QuadraticModel.fit(noisy(lorenz_series(), 0.01), LORENZ)
    start = np.array([1.0, 2.0, 20.0])
    outputs, memory = model.advance(start[:, np.newaxis], 40)
    basis = monomials(3, 2)

    def slope(_, state):
        values = np.array([np.prod(state[list(factors)]) for factors in basis])
        return values @ model.coefficients

    expected = solve_ivp(slope, (0, 0.4), start, rtol=1e-10, atol=1e-10).y[:, -1]
    np.testing.assert_allclose(outputs[-1, :, 0], expected, rtol=1e-5)
    np.testing.assert_array_equal(memory, outputs[-1])


def test_a_forecast_that_leaves_the_finite_numbers_disturbs_no_other():
    coefficients = np.zeros((6, 2))
    coefficients[3] = [1.0, 0.0]  # dx/dt = x^2, which is infinite at the time 1 / x
    coefficients[2] = [0.0, -1.0]
    system = PolynomialSystem(coefficients, 2, Lorenz63())
    model = QuadraticModel(system, 0.1, 1, coefficients)
    memory = np.array([[10.0, -1.0], [1.0, 1.0]])
    outputs, memory = model.advance(memory, 30)
    assert model.diverged(outputs).tolist() == [True, False]
    np.testing.assert_allclose(outputs[-1, :, 1], [-1 / 4, np.exp(-3)], rtol=1e-3)
    again, _ = model.advance(memory, 2)
    assert model.diverged(again).tolist() == [True, False]


def test_a_window_shorter_than_a_step_is_refused():
    case = ForecastingCase(**{**vars(LORENZ), "options": {**OPTIONS, "window_lt": 0.01}})
    with pytest.raises(
        ValueError, match=r"window_lt is 0\.01 Lyapunov times, which is shorter than one step"
    ):
        QuadraticModel.fit(lorenz_series(), case)
