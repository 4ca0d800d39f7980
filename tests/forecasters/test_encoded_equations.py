"""Equations that forecast encoded states of a flow: decoded, integrated, encoded again."""

from dataclasses import replace

import numpy as np
import pytest

from burstcast.data.dataset import component_scales, observed_series
from burstcast.encoders.channels import StateChannels, channel_names, encoding_case
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.equations_filtered import FilteredEquations
from burstcast.forecasters.equations_noisy import EquationsFromObservation
from burstcast.systems.integration import integrate
from burstcast.systems.kolmogorov import KolmogorovFlow
from burstcast.systems.measured import MeasuredSeries

FLOW = KolmogorovFlow(40.0, 4, 5)
GRID = {"points": [6, 6], "offset": [0.31, 0.17]}
STRIDE = 10


def with_observable(channels, states):
    """Channels of series, and the observable as the last of them."""
    observable = FLOW.observable(np.moveaxis(states, -1, 0))[..., np.newaxis]
    return np.concatenate([channels, observable], axis=-1)


@pytest.fixture(scope="module")
def setting():
    """Series of the flow, what sensors see of them, and the case of a forecaster."""
    start = FLOW.sample_initial_states(6, np.random.default_rng(6))
    states = integrate(FLOW, start, 0.05, 6000, STRIDE)[-300:].transpose(2, 0, 1)
    case = encoding_case(FLOW, GRID, {})
    readings = case.readings_of_series(states)
    scales = component_scales(readings)
    seen = observed_series(readings, 0, 0.01, scales, 1, "sensors")
    case = replace(case, noise=0.01 * scales.standard_deviation)
    channels = StateChannels.fit("identity", states, seen, case)
    space = MeasuredSeries(channel_names("identity", case), "observable")
    forecasting = ForecastingCase(
        space,
        0.05,
        STRIDE,
        17,
        {"noise": 0.01, "members": 12, "inflation": 1.1},
        source=FLOW,
        maps=channels.maps(states),
    )
    return states, with_observable(seen, states), channels, forecasting


def test_a_forecast_is_that_of_the_decoded_state(setting):
    _, seen, channels, case = setting
    forecaster = EquationsFromObservation.fit(seen, case)
    washout = seen[:2, :5].transpose(1, 2, 0)
    outputs, _ = forecaster.advance(forecaster.start(washout), 3)
    for row in range(2):
        estimate = case.maps.gain @ seen[row, 4, :-1] + case.maps.constant
        later = integrate(FLOW, estimate[:, None], 0.05, 3 * STRIDE, STRIDE)[1:, :, 0]
        expected = with_observable(channels.case.readings_of_series(later), later)
        np.testing.assert_allclose(outputs[:, :, row], expected, atol=1e-9)


def test_a_forecaster_is_restored(setting):
    _, seen, _, case = setting
    fitted = FilteredEquations.fit(seen, case)
    again = FilteredEquations.restore(fitted.record(), replace(case, maps=None))
    washout = seen[:1, :4].transpose(1, 2, 0)
    np.testing.assert_array_equal(fitted.start(washout), again.start(washout))


def test_the_filter_finds_the_state_that_the_sensors_do_not_see(setting):
    """Within half a Lyapunov time the error falls to a tenth of that of the linear estimate."""
    states, seen, _, case = setting
    filtered = FilteredEquations.fit(seen, case)
    washout = seen[:, 100:110].transpose(1, 2, 0)
    truth = states[:, 109].T
    linear = EquationsFromObservation.fit(seen, case).start(washout)
    errors = [np.linalg.norm(found - truth) for found in (linear, filtered.start(washout))]
    assert errors[1] < 0.1 * errors[0]
    members = filtered.ensemble(washout)
    assert members.shape == (FLOW.dimension, 12, 6)
    assert 0 < members.std(axis=1).mean() < np.abs(truth).mean()


def test_members_start_around_the_linear_estimate(setting):
    _, seen, _, case = setting
    filtered = FilteredEquations.fit(seen, case)
    first = filtered.first_members(seen[:2, 0].T).reshape(FLOW.dimension, 12, 2)
    np.testing.assert_allclose(first.mean(axis=1), case.maps.estimates(seen[:2, 0, :-1].T))
    errors = case.maps.error_covariance(filtered.noise[:-1])
    variances = np.linalg.eigvalsh(errors)[::-1]
    assert np.cov(first[..., 0]).trace() == pytest.approx(variances[:6].sum())
