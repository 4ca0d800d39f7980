"""The linear inverse model against a linear system, scikit-learn and a matrix power."""

import numpy as np
import pytest
from sklearn.linear_model import LinearRegression

from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.linear_inverse import LinearInverseModel
from burstcast.systems.lorenz63 import Lorenz63

CASE = ForecastingCase(Lorenz63(), 0.01, 2, 50, {})


@pytest.fixture
def series():
    return np.random.default_rng(1).standard_normal((4, 200, 3)).cumsum(axis=1)


def test_a_linear_system_is_found_and_continued():
    generator = np.random.default_rng(2)
    matrix = 0.4 * generator.standard_normal((3, 3))
    constant = np.array([1.0, -2.0, 0.5])
    states = [generator.standard_normal((3, 5))]
    for _ in range(30):
        states.append(matrix @ states[-1] + constant[:, np.newaxis])
    true = np.array(states)  # (time, dimension, series)
    model = LinearInverseModel.fit(true[:20].transpose(2, 0, 1), CASE)
    np.testing.assert_allclose(model.propagator, matrix, atol=1e-9)
    np.testing.assert_allclose(model.constant, constant, atol=1e-9)
    outputs, memory = model.advance(model.start(true[:20]), 11)
    np.testing.assert_allclose(outputs, true[20:], atol=1e-9)
    np.testing.assert_array_equal(memory, outputs[-1])


def test_it_is_the_regression_of_scikit_learn(series):
    model = LinearInverseModel.fit(series, CASE)
    now, following = (part.reshape(-1, 3) for part in (series[:, :-1], series[:, 1:]))
    expected = LinearRegression().fit(now, following)
    np.testing.assert_allclose(model.propagator, expected.coef_, atol=1e-10)
    np.testing.assert_allclose(model.constant, expected.intercept_, atol=1e-10)


def test_a_forecast_goes_on_where_it_stopped(series):
    model = LinearInverseModel.fit(series, CASE)
    memory = model.start(series[:, :10].transpose(1, 2, 0))
    whole, _ = model.advance(memory, 7)
    first, middle = model.advance(memory, 3)
    second, _ = model.advance(middle, 4)
    np.testing.assert_array_equal(whole, np.concatenate([first, second]))
