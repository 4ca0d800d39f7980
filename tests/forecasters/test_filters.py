"""The square-root filter against the Kalman filter of the textbook; static gains."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast.data.encoders._moments import kalman_gain
from burstcast.forecasters._square_root_filter import assimilate, mean, symmetric_members
from burstcast.forecasters.equations_filtered import leading_directions


def kalman_update(centre, covariance, observation, noise):
    """Textbook analysis of an observation of the first components."""
    observed = np.eye(noise.size, centre.size)
    innovation = observed @ covariance @ observed.T + np.diag(noise**2)
    gain = covariance @ observed.T @ np.linalg.inv(innovation)
    return (
        centre + gain @ (observation - observed @ centre),
        (np.eye(centre.size) - gain @ observed) @ covariance,
    )


@given(dimension=st.integers(1, 6), spare=st.integers(0, 20), seed=st.integers(0, 1000))
def test_the_first_ensemble_has_exactly_the_moments_of_the_noise(dimension, spare, seed):
    generator = np.random.default_rng(seed)
    centre, noise = generator.normal(size=(dimension, 3)), generator.uniform(0.1, 2, dimension)
    ensemble = symmetric_members(centre, noise, 2 * (dimension + spare))
    np.testing.assert_allclose(mean(ensemble), centre, atol=1e-12)
    for point in range(3):
        np.testing.assert_allclose(
            np.atleast_2d(np.cov(ensemble[:, :, point])), np.diag(noise**2), atol=1e-12
        )
    departures = ensemble - centre[:, np.newaxis]
    np.testing.assert_allclose(np.mean(departures**3, axis=1), 0, atol=1e-12)


@pytest.mark.parametrize("members", [7, 16])
def test_too_few_or_odd_members_are_refused(members):
    with pytest.raises(ValueError, match=f"{members} members .* an even number, at least 18"):
        symmetric_members(np.zeros((9, 1)), np.ones(9), members)


@given(
    dimension=st.integers(2, 5),
    observed=st.integers(1, 2),
    seed=st.integers(0, 1000),
    inflation=st.floats(1.0, 1.5),
)
def test_an_observation_moves_mean_and_covariance_as_kalmans_does(
    dimension, observed, seed, inflation
):
    generator = np.random.default_rng(seed)
    ensemble = generator.normal(size=(dimension, 15, 1)) @ np.ones((1, 2))
    ensemble[:, :, 1] = generator.normal(size=(dimension, 15)) * 3.0
    observation = generator.normal(size=(observed, 2))
    noise = generator.uniform(0.2, 2.0, observed)
    updated = assimilate(ensemble, observation, noise, inflation)
    for point in range(2):
        members = ensemble[:, :, point]
        centre, covariance = members.mean(axis=1), inflation**2 * np.cov(members)
        centre, covariance = kalman_update(centre, covariance, observation[:, point], noise)
        np.testing.assert_allclose(updated[:, :, point].mean(axis=1), centre, atol=1e-10)
        np.testing.assert_allclose(np.cov(updated[:, :, point]), covariance, atol=1e-10)
        # whatever else is in the batch
        others = np.where(np.arange(2) == point, ensemble, np.nan)
        alone = assimilate(others, observation, noise, inflation)
        np.testing.assert_array_equal(alone[:, :, point], updated[:, :, point])


def test_an_exact_observation_of_what_is_known_changes_nothing():
    """Neither members that agree nor what is observed without noise leave anything to divide by."""
    ensemble = np.array([[1.5] * 4, [1.0, 2.0, 3.0, 4.0]])[:, :, np.newaxis]
    updated = assimilate(ensemble, np.array([[7.0]]), np.zeros(1), 1.0)
    np.testing.assert_array_equal(updated, ensemble)
    updated = assimilate(ensemble[::-1].copy(), np.array([[7.0]]), np.zeros(1), 1.0)
    np.testing.assert_allclose(updated[0], 7.0, atol=1e-12)


def test_static_gains_are_the_kalman_filters_and_leading_directions_make_the_covariance():
    generator = np.random.default_rng(3)
    root, matrix = generator.normal(size=(6, 6)), generator.normal(size=(2, 6))
    covariance, noise = root @ root.T, np.array([0.3, 0.7])
    gain = kalman_gain(0.01 * covariance, matrix, noise)
    # in information form: (C^-1 / share + H' R^-1 H)^-1 H' R^-1
    precision = np.linalg.inv(0.01 * covariance) + matrix.T @ np.diag(noise**-2) @ matrix
    np.testing.assert_allclose(gain, np.linalg.solve(precision, matrix.T * noise**-2), rtol=1e-9)
    generator = np.random.default_rng(5)
    root = generator.normal(size=(5, 5))
    covariance = root @ root.T
    directions = leading_directions(covariance, 5)
    np.testing.assert_allclose(directions @ directions.T, covariance, rtol=1e-9, atol=1e-9)
    lengths = np.linalg.norm(directions, axis=0)
    assert (np.diff(lengths) < 0).all()
    np.testing.assert_array_equal(leading_directions(covariance, 2), directions[:, :2])
    largest = np.argmax(np.abs(directions), axis=0)
    assert (directions[largest, range(5)] > 0).all()
