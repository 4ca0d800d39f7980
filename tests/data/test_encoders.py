"""Encoders, channels and what instruments see, against other libraries, by hand, by symmetry."""

from dataclasses import replace

import numpy as np
import pytest
from sklearn.decomposition import PCA
from sklearn.linear_model import Ridge

from burstcast.data.dataset import component_scales, observed_series
from burstcast.data.encoders.base import EncodingCase
from burstcast.data.encoders.channels import (
    StateChannels,
    channel_names,
    check_encoding,
    encoding_case,
)
from burstcast.data.encoders.registry import encoder_class
from burstcast.data.observation.velocity_sensors import VelocitySensors
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from kolmogorov_flow import KolmogorovFlow

FLOW = KolmogorovFlow(20.0, 2, 5)
SENSORS = VelocitySensors(FLOW, (4, 4), (0.2, 0.3))


@pytest.fixture(scope="module")
def training():
    """Series of a developed flow, ``(series, time, component)``."""
    start = FLOW.sample_initial_states(3, np.random.default_rng(2))
    return np.moveaxis(integrate(FLOW, start, 0.05, 4000, 40)[-60:], (0, 1, 2), (1, 2, 0))


def images(snapshots):
    """All images of snapshots ``(snapshots, dimension)`` under the symmetries, made one by one."""
    blocks = [snapshots.T]
    for symmetry in FLOW.symmetries():
        for block in list(blocks):
            for _ in range(symmetry.order - 1):
                block = symmetry.transform(block)
                blocks.append(block)
    return np.concatenate(blocks, axis=1).T


def fitted(kind, training, **options):
    return encoder_class(kind).fit(training, EncodingCase(FLOW, options))


@pytest.mark.parametrize("options", [{}, {"symmetrised": False}])
def test_modes_are_the_principal_components_of_all_images(training, options):
    snapshots = training.reshape(-1, FLOW.dimension)
    everything = snapshots if options else images(snapshots)
    assert len(everything) == len(snapshots) * (1 if options else 11 * 4 * 2)
    oracle = PCA().fit(everything)
    encoder = fitted("pod", training, modes=9, **options)
    shares = encoder.variances / encoder.variances.sum()
    theirs = np.zeros(len(shares))
    theirs[: len(oracle.explained_variance_ratio_)] = oracle.explained_variance_ratio_
    np.testing.assert_allclose(shares, theirs, atol=1e-10)
    # modes of one variance may be rotated among themselves: the spaces must agree
    count = int(np.flatnonzero(-np.diff(theirs)[:9] > 1e-3)[-1]) + 1
    ours, theirs = encoder.modes[:, :count], oracle.components_[:count].T
    np.testing.assert_allclose(ours @ ours.T, theirs @ theirs.T, atol=1e-8)
    np.testing.assert_allclose(encoder.mean, oracle.mean_, atol=1e-10)
    centred = snapshots.T - oracle.mean_[:, np.newaxis]
    np.testing.assert_allclose(encoder.encode(snapshots.T), encoder.modes.T @ centred, atol=1e-9)


def test_a_share_of_the_variance_chooses_the_modes(training):
    encoder = fitted("pod", training, variance=0.9)
    held = np.cumsum(encoder.variances) / encoder.variances.sum()
    count = encoder.modes.shape[1]
    assert held[count - 2] < 0.9 <= held[count - 1]
    assert fitted("pod", training, modes=1).modes.shape == (FLOW.dimension, 1)
    whole = fitted("pod", training, variance=1.0)
    states = np.moveaxis(training, 2, 0)
    np.testing.assert_allclose(whole.decode(whole.encode(states)), states, atol=1e-10)
    lost = states - encoder.decode(encoder.encode(states))
    assert 0.0 < (lost**2).sum() < 0.3 * (states**2).sum()
    assert np.linalg.norm(encoder.encode(lost + encoder.mean[:, None, None])) < 1e-9


def test_symmetries_return_after_their_order(training):
    state = training[:, -1].T
    for symmetry in FLOW.symmetries():
        image = state
        for _ in range(symmetry.order):
            image = symmetry.transform(image)
        np.testing.assert_allclose(image, state, atol=1e-12)


def test_sensors_see_the_velocity_where_they_are(training):
    states = np.moveaxis(training, 2, 0)
    seen = SENSORS(states)
    assert seen.shape == (32, *states.shape[1:])
    place = SENSORS.channels.index("v_2_1")
    point = np.array([[0.2 + np.pi, 0.3 + np.pi / 2]])
    np.testing.assert_allclose(seen[place], FLOW.velocity(states, point)[1, 0], atol=1e-12)


def test_sensors_at_the_origin_miss_the_force_and_shifted_ones_see_it():
    flow = KolmogorovFlow()
    laminar = flow.laminar_state()
    assert np.abs(VelocitySensors(flow, (8, 8), (0.0, 0.0))(laminar)).max() < 1e-12
    assert np.abs(VelocitySensors(flow)(laminar)).max() > 1.0


def test_the_state_estimate_is_the_best_linear_one(training):
    """Least squares over images with noise drawn for each converge to it."""
    noise = np.full(32, 0.05)
    case = EncodingCase(FLOW, {}, SENSORS, noise)
    encoder = encoder_class("state_estimate").fit(training, case)
    states = images(training.reshape(-1, FLOW.dimension))
    generator = np.random.default_rng(5)
    true = np.tile(states, (4, 1))
    observed = SENSORS(true.T).T + noise * generator.standard_normal((len(true), 32))
    oracle = Ridge(alpha=1e-9).fit(observed, true)
    fresh = SENSORS(states.T) + noise[:, None] * generator.standard_normal((32, len(states)))
    ours, theirs = encoder.encode(fresh), oracle.predict(fresh.T).T
    error, of_oracle = (np.mean((estimate - states.T) ** 2) for estimate in (ours, theirs))
    assert error == pytest.approx(of_oracle, rel=0.01)
    assert error < 0.3 * states.var(axis=0).mean()
    np.testing.assert_allclose(encoder.decode(states.T), SENSORS(states.T), atol=1e-12)


def test_no_encoding():
    case = EncodingCase(Lorenz63())
    states = np.arange(24.0).reshape(3, 4, 2)
    identity = encoder_class("identity").fit(states, case)
    assert identity.channel_names(case) == ("x", "y", "z")
    assert identity.encode(states) is states
    assert identity.decode(states) is states


ALL = EncodingCase(FLOW)
OPTIONS = {
    name: EncodingCase(FLOW, {name: value}) for name, value in (("modes", 500), ("variance", 0))
}


@pytest.mark.parametrize(
    ("kind", "case", "message"),
    [
        ("pod", OPTIONS["modes"], "modes is 500; 180 snapshots of 120 components"),
        ("pod", ALL, "either modes or variance"),
        ("pod", OPTIONS["variance"], "variance must be above 0"),
        ("state_estimate", ALL, "nothing to estimate"),
        ("state_estimate", EncodingCase(FLOW, {}, SENSORS), "with noise"),
        ("podd", ALL, "did you mean 'pod'"),
    ],
)
def test_what_cannot_be_fitted_is_refused(kind, case, message, training):
    with pytest.raises(ValueError, match=message):
        encoder_class(kind).fit(training, case)


# -- channels of a state ---------------------------------------------------------------------------
GRID = {"points": [4, 4]}


def fitted_channels(training, kind, sensors, **options):
    case = encoding_case(FLOW, sensors, options)
    readings = case.readings_of_series(training)
    scales = component_scales(readings)
    case = replace(case, noise=0.02 * scales.standard_deviation)
    seen = observed_series(readings, 0, 0.02, scales, 1, "test")
    return StateChannels.fit(kind, training, seen, case)


@pytest.mark.parametrize(
    ("kind", "sensors", "options"),
    [
        ("identity", None, {}),
        ("identity", GRID, {}),
        ("state_estimate", GRID, {}),
        ("pod", None, {"modes": 7}),
        ("pod", GRID, {"modes": 7}),
    ],
)
def test_maps_are_the_encoding_and_the_decoding(training, kind, sensors, options):
    channels = fitted_channels(training, kind, sensors, **options)
    maps = channels.maps(training)
    states = training[1].T
    encoded = maps.channels(states)
    np.testing.assert_allclose(encoded, channels.encode(channels.case.readings(states)), atol=1e-10)
    names = channel_names(kind, encoding_case(FLOW, sensors, options))
    assert encoded.shape == (len(names), states.shape[1])
    estimates = maps.estimates(encoded)
    if channels.encoder.decodes and (sensors is None or channels.estimate is not None):
        np.testing.assert_allclose(estimates, channels.encoder.decode(encoded), atol=1e-10)
    error = np.mean((estimates - states) ** 2) / states.var(axis=1).mean()
    assert error < (1e-20 if (kind, sensors) == ("identity", None) else 0.5)


def test_the_covariance_of_the_error_is_that_of_simulated_errors(training):
    """Estimates from noisy readings of Gaussian states with the moments of the flow."""
    channels = fitted_channels(training, "identity", GRID)
    maps, noise = channels.maps(training), channels.case.noise
    generator = np.random.default_rng(8)
    root = np.linalg.cholesky(maps.covariance + 1e-12 * np.eye(FLOW.dimension))
    states = root @ generator.standard_normal((FLOW.dimension, 40_000))
    seen = maps.channels(states) + noise[:, None] * generator.standard_normal((32, 40_000))
    errors = maps.estimates(seen) - states
    expected = maps.error_covariance(noise)
    np.testing.assert_allclose(np.cov(errors), expected, atol=0.05 * expected.diagonal().max())
    assert expected.trace() < 0.3 * maps.covariance.trace()


def sensors(points, offset):
    return lambda: VelocitySensors(FLOW, points, offset)


def checked(kind, space=FLOW, sensors=None, options=None, noise=0.01):
    return lambda: check_encoding(kind, encoding_case(space, sensors, options or {}), noise, 180)


# sin(2 y) vanishes at multiples of pi / 2, and 4 sensors see 4 y as they see 0
BLIND = EncodingCase(FLOW, {}, VelocitySensors(FLOW, (4, 4), (0.1, 0.0)))


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (sensors((0, 4), (0.1, 0.1)), "points must be at least 1"),
        (sensors((4, 4), (1.6, 0.1)), "4 sensors along x from 1.6 on reach 6.312"),
        (sensors((4, 8), (0.1, -0.1)), "8 sensors along y from -0.1 on"),
        (checked("identity", Lorenz63(), GRID), "velocity in a plane, which Lorenz63 has not"),
        (checked("pod"), "modes must be a number from 1 to 120"),
        (checked("pod", sensors=GRID, options={"modes": 121}), "modes must be a number from 1 to"),
        (checked("state_estimate"), "there is nothing to estimate"),
        (checked("identity", sensors=GRID, options={"modes": 3}), "encoder.modes is no option"),
        (checked("pod", KolmogorovFlow(), options={"modes": 181}), "modes is 181; .* have 180 sn"),
        (checked("identity", sensors=GRID, noise=0.0), "training.noise is 0, but an estimate"),
        (lambda: check_encoding("identity", BLIND, 0.01, 180), "no sensor sees a_0_2, a_0_4: the"),
    ],
)
def test_what_cannot_be_encoded_is_refused(made, message):
    with pytest.raises(ValueError, match=message):
        made()
    checked("identity", noise=0.0)()
    checked("pod", KolmogorovFlow(), options={"modes": 180})()
    sensors((1, 1), (0.1, 0.1))()
