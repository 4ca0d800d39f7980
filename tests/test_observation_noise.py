"""The noise of observed series, estimated, against what was put in."""

import numpy as np
import pytest

from burstcast.data.observation_noise import estimate_noise, observation_noise
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63


@pytest.fixture(scope="module")
def series():
    start = np.random.default_rng(3).normal(size=(3, 4)) + np.array([[1.0], [1.0], [25.0]])
    return integrate(Lorenz63(), start, 0.01, 2 * 3000, stride=2)[501:].transpose(2, 0, 1)


@pytest.mark.parametrize("noise", [0.001, 0.01, 0.1])
def test_the_noise_of_a_chaotic_system_is_found(noise, series):
    added = noise * series.std(axis=(0, 1)) * np.array([1.0, 2.0, 0.5])
    observed = series + added * np.random.default_rng(5).standard_normal(series.shape)
    np.testing.assert_allclose(estimate_noise(observed), added, rtol=0.05)


def test_polynomials_have_no_noise():
    time = np.linspace(-1, 1, 60)[:, np.newaxis]
    smooth = np.concatenate([time**7 - time, 2 - time**4], axis=1)[np.newaxis]
    assert (estimate_noise(smooth) < 1e-14).all()


def test_known_noise_is_not_estimated(series):
    np.testing.assert_allclose(observation_noise(series, 0.25), 0.25 * series.std(axis=(0, 1)))
    np.testing.assert_array_equal(observation_noise(series, None), estimate_noise(series))


def test_series_that_are_too_short_are_refused():
    with pytest.raises(ValueError, match="series of 8 samples"):
        estimate_noise(np.zeros((3, 8, 2)))
