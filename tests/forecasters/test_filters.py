"""The square-root filter against the Kalman filter of the textbook; static gains."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast.data.encoders._moments import kalman_gain
from burstcast.forecasters._ensemble_smoother import combined, follow, joined, opposite_pairs
from burstcast.forecasters._square_root_filter import (
    assimilate,
    combinations,
    mean,
    symmetric_members,
)
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


# -- the filter of networks ------------------------------------------------------------------------


@given(
    observed=st.integers(1, 4),
    further=st.integers(0, 5),
    pairs=st.integers(2, 8),
    seed=st.integers(0, 1000),
)
def test_weights_of_the_members_are_the_update_of_their_rows(observed, further, pairs, seed):
    generator = np.random.default_rng(seed)
    ensemble = generator.normal(size=(observed + further, 2 * pairs, 3)) * 2.0 + 1.0
    observation, noise = generator.normal(size=(observed, 3)), generator.uniform(0.2, 2, observed)
    rows = ensemble.transpose(0, 2, 1)
    weights = combinations(rows[:observed], observation, noise)
    expected = assimilate(ensemble, observation, noise, 1.0).transpose(0, 2, 1)
    np.testing.assert_allclose(combined(rows, weights), expected, atol=1e-10)
    # a member that is not finite spoils its point alone
    broken = rows[:observed].copy()
    broken[0, 1, 2] = np.nan
    spoilt = combinations(broken, observation, noise)
    np.testing.assert_array_equal(spoilt[[0, 2]], weights[[0, 2]])
    assert np.isnan(spoilt[1]).all()


def test_weights_of_members_that_agree_on_an_exact_observation_change_nothing():
    forecast = np.array([[[1.5] * 4]])
    weights = combinations(forecast, np.array([[7.0]]), np.zeros(1))
    np.testing.assert_allclose(weights[0], np.eye(4), atol=1e-15)


class LinearModel:
    """State r, next sample H r, and r <- A r + B sample: a `DrivenModel` with known statistics."""

    def __init__(self, generator, rows=3, dimension=2):
        self.transition = 0.5 * generator.normal(size=(rows, rows)) / np.sqrt(rows)
        self.driving = 0.7 * generator.normal(size=(rows, dimension))
        self.readout = 0.6 * generator.normal(size=(dimension, rows))
        undisturbed = self.transition + self.driving @ self.readout
        radius = np.abs(np.linalg.eigvals(undisturbed)).max()
        self.transition, self.driving = 0.9 / radius * self.transition, 0.9 / radius * self.driving

    hidden = slice(0)

    def begin(self, samples, number):
        return np.zeros((len(self.transition), *samples.shape[1:]))

    def predict(self, states):
        return np.einsum("ij,jbm->ibm", self.readout, states)

    def drive(self, states, samples, number):
        return np.einsum("ij,jbm->ibm", self.transition, states) + np.einsum(
            "ij,jbm->ibm", self.driving, samples
        )

    def simulate(self, generator, steps, model_error, noise):
        """True samples and observed ones, ``(steps, dimension)``."""
        state, samples = np.zeros(len(self.transition)), []
        for step in range(steps):
            error = generator.normal(size=len(noise)) * (model_error if step else 1.0)
            samples.append(self.readout @ state + error)
            state = self.transition @ state + self.driving @ samples[-1]
        true = np.array(samples)
        return true, true + noise * generator.normal(size=true.shape)


def kalman_and_rauch_tung_striebel(model, observed, noise, model_error):
    """Textbook filter and smoother of (sample, state before it): their means and covariances.

    The first sample is known by its observation alone, and the first state exactly.
    """
    dimension, rows = model.readout.shape
    size = dimension + rows
    matrix = np.zeros((size, size))
    matrix[dimension:] = np.hstack([model.driving, model.transition])
    matrix[:dimension] = model.readout @ matrix[dimension:]
    added = np.zeros((size, size))
    added[:dimension, :dimension] = np.diag(model_error**2)
    mean_now, covariance = np.zeros(size), np.zeros((size, size))
    mean_now[:dimension] = observed[0]
    covariance[:dimension, :dimension] = np.diag(noise**2)
    filtered, forecasts = [(mean_now, covariance)], [None]
    for observation in observed[1:]:
        ahead = matrix @ mean_now, matrix @ covariance @ matrix.T + added
        mean_now, covariance = kalman_update(*ahead, observation, noise)
        forecasts.append(ahead)
        filtered.append((mean_now, covariance))
    smoothed = [filtered[-1]]
    for step in range(len(observed) - 2, -1, -1):
        (mean_now, covariance), (ahead, spread) = filtered[step], forecasts[step + 1]
        gain = covariance @ matrix.T @ np.linalg.pinv(spread, rcond=1e-11)
        later, of_later = smoothed[0]
        smoothed.insert(
            0,
            (
                mean_now + gain @ (later - ahead),
                covariance + gain @ (of_later - spread) @ gain.T,
            ),
        )
    return filtered, smoothed


def orthogonal_numbers(generator, steps, dimension, members):
    """Numbers of all steps with exactly the moments of independent standard normal numbers."""
    count = steps * dimension
    basis = np.linalg.qr(
        np.column_stack([np.ones(members), generator.normal(size=(members, count))])
    )[0][:, 1:]
    return iter((np.sqrt(members - 1) * basis.T).reshape(steps, dimension, members))


@pytest.mark.parametrize("seed", range(3))
def test_filter_and_smoother_of_a_linear_model_are_kalmans_and_rauch_tung_and_striebels(seed):
    generator = np.random.default_rng(seed)
    model, noise, model_error = LinearModel(generator), np.array([0.4, 0.7]), np.array([0.3, 0.2])
    steps, members = 12, 40
    series = [model.simulate(generator, steps, model_error, noise)[1] for _ in range(2)]
    for lag in (0, steps):
        numbers = orthogonal_numbers(generator, steps, 2, members)
        followed = follow(model, np.array(series), noise, numbers, model_error, start_up=1, lag=lag)
        spread = np.zeros(2)
        for row, observed in enumerate(series):
            filtered, smoothed = kalman_and_rauch_tung_striebel(model, observed, noise, model_error)
            for step, (mean_now, covariance) in enumerate(smoothed if lag else filtered):
                np.testing.assert_allclose(
                    followed.smoothed[row, step], mean_now[:2], rtol=1e-8, atol=1e-8
                )
                spread += covariance.diagonal()[:2] / (steps * len(series))
            # the state that the last sample has driven
            mean_now, covariance = filtered[-1]
            driving = np.hstack([model.driving, model.transition])
            states = followed.states[:, row]
            np.testing.assert_allclose(states.mean(axis=1), driving @ mean_now, atol=1e-8)
            np.testing.assert_allclose(np.cov(states), driving @ covariance @ driving.T, atol=1e-8)
        np.testing.assert_allclose(followed.spread**2, spread, atol=1e-8)


def test_the_error_of_a_model_is_found_from_its_innovations():
    generator = np.random.default_rng(4)
    model, noise, model_error = LinearModel(generator), np.array([0.4, 0.7]), np.array([0.4, 0.2])
    observed = np.array([model.simulate(generator, 1500, model_error, noise)[1] for _ in range(12)])
    followed = follow(model, observed, noise, opposite_pairs(1, 2, 30), None, start_up=5, lag=3)
    np.testing.assert_allclose(followed.model_error, model_error, rtol=0.2)
    np.testing.assert_allclose(followed.consistency, 1.0, atol=0.05)


def test_series_that_have_ended_have_no_influence():
    generator = np.random.default_rng(5)
    model, noise, model_error = LinearModel(generator), np.array([0.4, 0.7]), np.array([0.3, 0.2])
    lengths = np.array([60, 41, 44])
    observed = np.array([model.simulate(generator, 60, model_error, noise)[1] for _ in lengths])
    options = {"start_up": 4, "lag": 7}
    together = follow(
        model, observed, noise, opposite_pairs(1, 2, 20), model_error, lengths=lengths, **options
    )
    for row, length in enumerate(lengths):
        alone = follow(
            model,
            observed[row : row + 1, :length],
            noise,
            opposite_pairs(1, 2, 20),
            model_error,
            **options,
        )
        np.testing.assert_array_equal(together.smoothed[row, :length], alone.smoothed[0])
        assert np.isnan(together.smoothed[row, length:]).all()
    # nor has a division of the series into batches
    whole, *parts = (
        follow(model, rows, noise, opposite_pairs(1, 2, 20), model_error, keep=(3, 20), **options)
        for rows in (observed, observed[:2], observed[2:])
    )
    several = joined(parts, (2, 1))
    for name in ("states", "smoothed"):
        np.testing.assert_array_equal(getattr(several, name), getattr(whole, name))
    np.testing.assert_allclose(several.spread, whole.spread, rtol=1e-12)
    for step in (3, 20):
        np.testing.assert_array_equal(several.kept[step], whole.kept[step])
    # nor on the estimate of the error
    estimates = []
    for after in (0.0, 100.0):
        changed = observed.copy()
        changed[1, 41:], changed[2, 44:] = after, -after
        numbers = opposite_pairs(1, 2, 20)
        estimates.append(follow(model, changed, noise, numbers, None, lengths=lengths, **options))
    np.testing.assert_array_equal(estimates[0].model_error, estimates[1].model_error)
    np.testing.assert_array_equal(estimates[0].smoothed, estimates[1].smoothed)
