"""Forecasters with a filter in front: what it is worth, and what it must not depend on."""

import numpy as np
import pytest

from burstcast.forecasters._filtered import FilteredForecaster
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.equations_filtered import FilteredEquations
from burstcast.forecasters.linear_inverse import LinearInverseModel
from burstcast.forecasters.quadratic_filtered import FilteredQuadraticModel
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63

OPTIONS = {
    "noise": None,
    "degree": 2,
    "window_lt": 0.2,
    "significance": 4.0,
    "members": 40,
    "inflation": 1.0,
}
CASE = ForecastingCase(Lorenz63(), 0.01, 2, 50, OPTIONS)
KINDS = (FilteredEquations, FilteredQuadraticModel)


@pytest.fixture(scope="module")
def true():
    """Chaotic trajectories, (500, 3, 60), sampled at 0.02."""
    start = np.random.default_rng(3).normal(size=(3, 60)) + np.array([[1.0], [1.0], [25.0]])
    return integrate(CASE.system, start, 0.01, 2 * 1000, stride=2)[501:]


@pytest.fixture(scope="module")
def noise(true):
    return 0.02 * true.std(axis=(0, 2))


@pytest.fixture(scope="module")
def observed(true, noise):
    deviation = np.random.default_rng(4).standard_normal(true.shape)
    return true + noise[:, np.newaxis] * deviation


@pytest.mark.parametrize("kind", KINDS)
def test_the_estimate_is_much_better_than_an_observation(kind, true, observed, noise):
    model = kind.fit(observed[:, :, :10].transpose(2, 0, 1), CASE)
    np.testing.assert_allclose(model.noise, noise, rtol=0.05)
    errors, spreads = [], []
    for start in range(0, 470, 50):
        washout = observed[start : start + 30, :, 10:]
        errors.append(model.start(washout) - true[start + 29, :, 10:])
        spreads.append(model.ensemble(washout).std(axis=1, ddof=1))
    error, spread = (
        np.sqrt(np.square(np.array(values) / noise[:, np.newaxis]).mean())
        for values in (errors, spreads)
    )
    assert error < 0.3
    # the scatter of the members is the error that there is
    assert spread == pytest.approx(error, rel=0.15)


@pytest.mark.parametrize("kind", KINDS)
def test_results_do_not_depend_on_the_batch(kind, observed):
    model = kind.fit(observed[:, :, :10].transpose(2, 0, 1), CASE)
    washout = observed[100:115, :, 10:41]
    together = model.start(washout)
    for first, last in ((0, 1), (1, 9), (9, 31)):
        part = np.ascontiguousarray(washout[:, :, first:last])
        np.testing.assert_array_equal(model.start(part), together[:, first:last])


def test_a_washout_of_one_step_is_its_observation(observed):
    model = FilteredEquations.fit(observed[:, :, :10].transpose(2, 0, 1), CASE)
    np.testing.assert_allclose(model.start(observed[:1]), observed[0], atol=1e-12)


def test_known_noise_is_believed(observed):
    training = observed[:, :, :10].transpose(2, 0, 1)
    case = ForecastingCase(**{**vars(CASE), "options": {**OPTIONS, "noise": 0.3}})
    model = FilteredEquations.fit(training, case)
    np.testing.assert_allclose(model.noise, 0.3 * training.std(axis=(0, 1)))


class FilteredLinearModel(FilteredForecaster):
    """Any forecaster may be filtered."""

    model_class = LinearInverseModel


def test_around_a_linear_model_it_is_the_kalman_filter(observed):
    training = observed[:, :, :10].transpose(2, 0, 1)
    filtered = FilteredLinearModel.fit(training, CASE)
    model, noise = filtered.model, filtered.noise
    washout = observed[100:120, :, 11]
    centre, covariance = washout[0], np.diag(noise**2)
    for observation in washout[1:]:
        centre = model.propagator @ centre + model.constant
        covariance = model.propagator @ covariance @ model.propagator.T
        gain = covariance @ np.linalg.inv(covariance + np.diag(noise**2))
        centre = centre + gain @ (observation - centre)
        covariance = covariance - gain @ covariance
    members = filtered.ensemble(washout[:, :, np.newaxis])
    np.testing.assert_allclose(filtered.start(washout[:, :, np.newaxis])[:, 0], centre, atol=1e-8)
    np.testing.assert_allclose(np.cov(members[:, :, 0]), covariance, atol=1e-8)
