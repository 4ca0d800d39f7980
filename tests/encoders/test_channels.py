"""From states to channels: the affine maps of equations, against simulation and by hand."""

from dataclasses import replace

import numpy as np
import pytest

from burstcast.data.dataset import component_scales, observed_series
from burstcast.encoders.channels import StateChannels, channel_names, check_encoding, encoding_case
from burstcast.systems.integration import integrate
from burstcast.systems.kolmogorov import KolmogorovFlow
from burstcast.systems.lorenz63 import Lorenz63

FLOW = KolmogorovFlow(20.0, 2, 5)
GRID = {"points": [4, 4], "offset": [0.2, 0.3]}


@pytest.fixture(scope="module")
def training():
    """Series of a developed flow, ``(series, time, component)``."""
    start = FLOW.sample_initial_states(3, np.random.default_rng(4))
    return np.moveaxis(integrate(FLOW, start, 0.05, 4000, 40)[-60:], (0, 1, 2), (1, 2, 0))


def fitted(training, kind, sensors, **options):
    case = encoding_case(FLOW, sensors, options)
    readings = case.readings_of_series(training)
    scales = component_scales(readings)
    case = replace(case, noise=0.02 * scales.standard_deviation)
    seen = observed_series(readings, 0, 0.02, scales, 1, "test")
    return StateChannels.fit(kind, training, seen, case), seen


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
    channels, _ = fitted(training, kind, sensors, **options)
    maps = channels.maps(training)
    states = training[1].T
    found = maps.channels(states)
    np.testing.assert_allclose(found, channels.encode(channels.case.readings(states)), atol=1e-10)
    names = channel_names(kind, encoding_case(FLOW, sensors, options))
    assert found.shape == (len(names), states.shape[1])
    estimates = maps.estimates(found)
    if channels.encoder.decodes and (sensors is None or channels.estimate is not None):
        np.testing.assert_allclose(estimates, channels.encoder.decode(found), atol=1e-10)
    error = np.mean((estimates - states) ** 2) / states.var(axis=1).mean()
    assert error < (1e-20 if (kind, sensors) == ("identity", None) else 0.5)


def test_the_covariance_of_the_error_is_that_of_simulated_errors(training):
    """Estimates from noisy readings of Gaussian states with the moments of the flow."""
    channels, _ = fitted(training, "identity", GRID)
    maps, noise = channels.maps(training), channels.case.noise
    generator = np.random.default_rng(8)
    root = np.linalg.cholesky(maps.covariance + 1e-12 * np.eye(FLOW.dimension))
    states = root @ generator.standard_normal((FLOW.dimension, 40_000))
    seen = maps.channels(states) + noise[:, None] * generator.standard_normal((32, 40_000))
    errors = maps.estimates(seen) - states
    expected = maps.error_covariance(noise)
    np.testing.assert_allclose(np.cov(errors), expected, atol=0.05 * expected.diagonal().max())
    assert expected.trace() < 0.3 * maps.covariance.trace()


def test_invariants_from_sensors_are_those_of_the_estimate(training):
    channels, seen = fitted(training, "invariants", GRID)
    assert not channels.decodes
    estimate = channels.estimate.encode(np.moveaxis(seen, -1, 0))
    expected = np.moveaxis(FLOW.invariants(estimate), 0, -1)
    np.testing.assert_array_equal(channels.encode_series(seen), expected)
    with pytest.raises(NotImplementedError, match="does not decode"):
        channels.maps(training)


@pytest.mark.parametrize(
    ("space", "kind", "sensors", "options", "message"),
    [
        (Lorenz63(), "identity", GRID, {}, "velocity in a plane, which Lorenz63 has not"),
        (Lorenz63(), "invariants", None, {}, "Lorenz63 has no invariants"),
        (FLOW, "pod", None, {}, "modes must be a number from 1 to 120"),
        (FLOW, "pod", GRID, {"modes": 121}, "modes must be a number from 1 to 120"),
        (FLOW, "state_estimate", None, {}, "there is nothing to estimate"),
        (FLOW, "invariants", None, {"modes": 3}, "encoder.modes is no option of the encoder inv"),
        (FLOW, "identity", GRID, {"modes": 3}, "encoder.modes is no option"),
        (KolmogorovFlow(), "pod", None, {"modes": 181}, "modes is 181; .* have 180 snapshots"),
        # sin(2 y) vanishes at multiples of pi / 2, and 4 sensors see 4 y as they see 0
        (
            FLOW,
            "identity",
            {"points": [4, 4], "offset": [0.1, 0.0]},
            {},
            "no sensor sees a_0_2, a_0_4: the velocity",
        ),
    ],
)
def test_what_cannot_be_encoded(space, kind, sensors, options, message):
    with pytest.raises(ValueError, match=message):
        check_encoding(kind, encoding_case(space, sensors, options), 0.01, 180)


def test_sensors_take_noise():
    with pytest.raises(ValueError, match=r"training.noise is 0, but an estimate of the state"):
        check_encoding("identity", encoding_case(FLOW, GRID, {}), 0.0, 180)
    check_encoding("identity", encoding_case(FLOW, None, {}), 0.0, 180)
