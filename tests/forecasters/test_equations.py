"""Learnt and encoded equations, and filters in front of them, against what made the series."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.stats import norm

from burstcast.data.dataset import component_scales, observed_series
from burstcast.data.encoders.channels import StateChannels, channel_names, encoding_case
from burstcast.forecasters._filtered import INFLATIONS, FilteredForecaster, _ends_of_segments
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.equations_filtered import FilteredEquations
from burstcast.forecasters.equations_noisy import EquationsFromObservation
from burstcast.forecasters.linear_inverse import LinearInverseModel
from burstcast.forecasters.quadratic import QuadraticModel
from burstcast.forecasters.quadratic_filtered import FilteredQuadraticModel
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.measured import MeasuredSeries
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.polynomials.basis import monomials
from burstcast.systems.polynomials.system import PolynomialSystem
from helpers_library import lorenz_series
from kolmogorov_flow import KolmogorovFlow

LORENZ = ForecastingCase(Lorenz63(), 0.01, 1, 60)
FLOW = ForecastingCase(MoehlisFaisstEckhardt(reynolds=400.0), 0.25, 4, 61)


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


@pytest.mark.parametrize(("noise", "error"), [(0, 5e-6), (0.001, 2e-4), (0.01, 2e-3), (0.05, 1e-2)])
def test_the_error_of_the_field_is_a_fraction_of_the_noise(noise, error, flow_series):
    model = QuadraticModel().fit(noisy(flow_series, noise), FLOW)
    assert field_error(model, FLOW.system, flow_series[0]) < error


def test_insignificant_terms_are_left_out_and_no_others(flow_series, monkeypatch):
    observed = noisy(flow_series, 0.01)
    model = QuadraticModel().fit(observed, FLOW)
    # each coefficient of the true equations, from their second differences at random states
    states = np.random.default_rng(4).normal(size=(9, 400))
    basis = monomials(9, 2)
    values = np.array([np.prod(states[list(factors)], axis=0) for factors in basis])
    true = np.linalg.lstsq(values.T, FLOW.system.right_hand_side(states).T)[0]
    there, known = np.abs(true) > 1e-9, model.coefficients != 0
    assert not (there & ~known).any()
    assert (known & ~there).sum() <= 2
    monkeypatch.setattr("burstcast.forecasters.quadratic.SIGNIFICANCE", 0)
    everything = QuadraticModel().fit(observed, FLOW)
    assert (everything.coefficients != 0).all()
    errors = [field_error(each, FLOW.system, flow_series[1]) for each in (model, everything)]
    assert errors[0] < 0.6 * errors[1]


def test_a_forecast_that_leaves_the_finite_numbers_disturbs_no_other():
    coefficients = np.zeros((6, 2))
    coefficients[3] = [1.0, 0.0]  # dx/dt = x^2, which is infinite at the time 1 / x
    coefficients[2] = [0.0, -1.0]
    system = PolynomialSystem(coefficients, 2, Lorenz63())
    model = QuadraticModel(
        system=system, time_step=0.1, sampling_stride=1, coefficients=coefficients
    )
    memory = np.array([[10.0, -1.0], [1.0, 1.0]])
    outputs, memory = model.advance(memory, 30)
    assert model.diverged(outputs).tolist() == [True, False]
    np.testing.assert_allclose(outputs[-1, :, 1], [-1 / 4, np.exp(-3)], rtol=1e-3)
    again, _ = model.advance(memory, 2)
    assert model.diverged(again).tolist() == [True, False]


def test_a_window_shorter_than_a_step_is_refused():
    with pytest.raises(
        ValueError, match=r"window_lt .* is 0\.01 Lyapunov times, which is shorter than one step"
    ):
        QuadraticModel(window_lt=0.01).fit(lorenz_series(4, 500, 600), LORENZ)


# -- filters ---------------------------------------------------------------------------------------

FILTERED = ForecastingCase(Lorenz63(), 0.01, 2, 50)
KINDS = (FilteredEquations, FilteredQuadraticModel)


@pytest.fixture(scope="module")
def true():
    """Chaotic trajectories, (500, 3, 60), sampled at 0.02."""
    return lorenz_series(60, 501, 1001).transpose(1, 2, 0)


@pytest.fixture(scope="module")
def noise(true):
    return 0.02 * true.std(axis=(0, 2))


@pytest.fixture(scope="module")
def observed(true, noise):
    deviation = np.random.default_rng(4).standard_normal(true.shape)
    return true + noise[:, np.newaxis] * deviation


@pytest.mark.parametrize("kind", KINDS)
def test_the_estimate_is_much_better_than_an_observation(kind, true, observed, noise):
    model = kind(members=40).fit(observed[:, :, :10].transpose(2, 0, 1), FILTERED)
    np.testing.assert_allclose(model.errors, noise, rtol=0.05)
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


def test_known_noise_is_believed_and_a_washout_of_one_step_is_its_observation(observed):
    model = FilteredEquations().fit(observed[:, :, :10].transpose(2, 0, 1), FILTERED)
    np.testing.assert_allclose(model.start(observed[:1]), observed[0], atol=1e-12)
    training = observed[:, :, :10].transpose(2, 0, 1)
    model = FilteredEquations(noise=0.3).fit(training, FILTERED)
    np.testing.assert_allclose(model.errors, 0.3 * training.std(axis=(0, 1)))


@dataclass(frozen=True)
class FilteredLinearModel(FilteredForecaster):
    """Any forecaster may be filtered."""

    model_class = LinearInverseModel


def test_around_a_linear_model_it_is_the_kalman_filter(observed):
    training = observed[:, :, :10].transpose(2, 0, 1)
    filtered = FilteredLinearModel(inflation=1.0).fit(training, FILTERED)
    model, noise = filtered.model, filtered.errors
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


ROTATION = 0.99 * np.array([[np.cos(0.3), -np.sin(0.3)], [np.sin(0.3), np.cos(0.3)]])


def linear_flow(series, samples, drift, seed=0):
    """A damped rotation with random forcing of this size, and noise of 0.1 in each component."""
    generator = np.random.default_rng(seed)
    states = np.empty((samples, 2, series))
    states[0] = generator.normal(size=(2, series))
    for step in range(1, samples):
        states[step] = ROTATION @ states[step - 1] + drift * generator.normal(size=(2, series))
    return states + 0.1 * generator.normal(size=states.shape)


def test_innovations_have_the_likelihood_of_the_textbooks_kalman_filter(observed):
    """One component after the other, from their normal distributions."""
    filtered = FilteredLinearModel(inflation=1.1, noise=0.05)
    filtered = filtered.fit(observed[:, :, :10].transpose(2, 0, 1), FILTERED)
    model, noise, washout = filtered.model, filtered.errors, observed[100:120, :, 11]
    centre, covariance, logs = washout[0], np.diag(noise**2), []
    for observation in washout[1:]:
        centre = model.propagator @ centre + model.constant
        covariance = 1.1**2 * model.propagator @ covariance @ model.propagator.T
        spread = np.sqrt(covariance.diagonal() + noise**2)
        logs.append(norm(centre, spread).logpdf(observation).sum())
        gain = covariance @ np.linalg.inv(covariance + np.diag(noise**2))
        centre = centre + gain @ (observation - centre)
        covariance = covariance - gain @ covariance
    counted = logs[len(logs) // 4 :]
    expected = sum(counted) + len(counted) * 3 * 0.5 * np.log(2 * np.pi)
    found = filtered._log_likelihood(washout[:, :, np.newaxis])
    np.testing.assert_allclose(found, expected, rtol=1e-6)


@pytest.mark.parametrize(("drift", "inflated"), [(0.0, False), (0.1, True)])
def test_inflation_is_chosen_where_the_model_errs_and_nowhere_else(drift, inflated):
    """Without forcing the linear model is exact; with it, no ensemble knows of the forcing."""
    training = linear_flow(8, 400, drift, seed=1).transpose(2, 0, 1)
    exact = LinearInverseModel().with_fitted(propagator=ROTATION, constant=np.zeros(2))
    unknown = FilteredLinearModel().with_fitted(model=exact, errors=np.full(2, 0.1))
    chosen = unknown._with_chosen_inflation(training, 50)
    assert (chosen.chosen_inflation > 1.0) == inflated
    words = " ".join(chosen.weaknesses())
    assert ("further from its forecasts than noise and ensemble explain" in words) == inflated
    test = linear_flow(200, 30, drift, seed=2)
    assert chosen.tuned().inflation == chosen.chosen_inflation
    again = chosen.restore(chosen.record(), FILTERED)
    np.testing.assert_array_equal(again.start(test), chosen.start(test))
    assert again.chosen_inflation == chosen.chosen_inflation
    # one segment has a likelihood, and no scatter
    alone = unknown._with_chosen_inflation(training[:1, :60], 50)
    logs = [
        replace(unknown, chosen_inflation=factor)._log_likelihood(training[0, :50, :, np.newaxis])
        for factor in INFLATIONS
    ]
    assert alone.chosen_inflation == INFLATIONS[int(np.argmax(logs))]


@pytest.mark.parametrize("length", [30, 400])
def test_inflation_is_judged_by_so_many_segments_at_most(length):
    """Disjoint ones, within each series, from the first to the last series."""
    training = linear_flow(9, length, 0.0, seed=1).transpose(2, 0, 1)
    training[4, length // 2 :] = np.nan
    ends = _ends_of_segments(training, 10)
    assert len(ends.series) == {30: 8 * 3 + 1, 400: -(-340 // 6)}[length]
    assert {*ends.series} == {*range(9)}
    assert ((ends.step + 1) % 10 == 0).all()
    assert not np.isnan(training[ends.series, ends.step]).any()


def test_a_chosen_inflation_of_one_is_the_filter_without_inflation(observed):
    training = observed[:, :, :10].transpose(2, 0, 1)
    chosen, plain = (
        FilteredEquations(inflation=given).fit(training, FILTERED) for given in (None, 1)
    )
    assert chosen.chosen_inflation == 1.0
    assert chosen.weaknesses() == []
    np.testing.assert_array_equal(chosen.start(observed[:30]), plain.start(observed[:30]))
    unequal = np.where(np.arange(500)[:, np.newaxis] < 300, training, np.nan)
    assert FilteredEquations(noise=0.02).fit(unequal, FILTERED).chosen_inflation == 1.0
    exact = FilteredEquations(noise=0.0).fit(training, FILTERED)
    assert exact.chosen_inflation == 1.0


# -- encoded states --------------------------------------------------------------------------------

KOLMOGOROV = KolmogorovFlow(40.0, 4, 5)
STRIDE = 10
FILTER = FilteredEquations(noise=0.01, members=12, inflation=1.1)


def with_observable(flow, channels, states):
    """Channels of series, and the observable as the last of them."""
    observable = flow.observable(np.moveaxis(states, -1, 0))[..., np.newaxis]
    return np.concatenate([channels, observable], axis=-1)


def encoded(flow, sensors, states, *times):
    """What sensors see of series and the observable, the channels, and the case of a forecaster."""
    case = encoding_case(flow, sensors, {})
    readings = case.readings_of_series(states)
    scales = component_scales(readings)
    seen = observed_series(readings, 0, 0.01, scales, 1, "sensors")
    case = replace(case, noise=0.01 * scales.standard_deviation)
    channels = StateChannels.fit("identity", states, seen, case)
    space = MeasuredSeries(channel_names("identity", case), "observable")
    forecasting = ForecastingCase(space, *times, source=flow, maps=channels.maps(states))
    return with_observable(flow, seen, states), channels, forecasting


@pytest.fixture(scope="module")
def setting():
    """Series of the flow, what sensors see of them, and the case of a forecaster."""
    start = KOLMOGOROV.sample_initial_states(6, np.random.default_rng(6))
    states = integrate(KOLMOGOROV, start, 0.05, 2500, STRIDE)[-200:].transpose(2, 0, 1)
    return states, *encoded(KOLMOGOROV, {"points": [6, 6]}, states, 0.05, STRIDE, 17)


def test_a_forecast_is_that_of_the_decoded_state(setting):
    _, seen, channels, case = setting
    forecaster = EquationsFromObservation().fit(seen, case)
    washout = seen[:2, :5].transpose(1, 2, 0)
    outputs, _ = forecaster.advance(forecaster.start(washout), 3)
    for row in range(2):
        estimate = case.maps.gain @ seen[row, 4, :-1] + case.maps.constant
        later = integrate(KOLMOGOROV, estimate[:, None], 0.05, 3 * STRIDE, STRIDE)[1:, :, 0]
        expected = with_observable(KOLMOGOROV, channels.case.readings_of_series(later), later)
        np.testing.assert_allclose(outputs[:, :, row], expected, atol=1e-9)


def test_a_forecaster_is_restored(setting):
    _, seen, _, case = setting
    fitted = FILTER.fit(seen, case)
    again = FILTER.restore(fitted.record(), replace(case, maps=None))
    washout = seen[:1, :4].transpose(1, 2, 0)
    np.testing.assert_array_equal(fitted.start(washout), again.start(washout))


def test_the_filter_finds_the_state_that_the_sensors_do_not_see(setting):
    """Within half a Lyapunov time the error falls to a tenth of that of the linear estimate."""
    states, seen, _, case = setting
    filtered = FILTER.fit(seen, case)
    washout = seen[:, 100:110].transpose(1, 2, 0)
    truth = states[:, 109].T
    linear = EquationsFromObservation().fit(seen, case).start(washout)
    errors = [np.linalg.norm(estimate - truth) for estimate in (linear, filtered.start(washout))]
    assert errors[1] < 0.1 * errors[0]
    members = filtered.ensemble(washout)
    assert members.shape == (KOLMOGOROV.dimension, 12, 6)
    assert 0 < members.std(axis=1).mean() < np.abs(truth).mean()


def test_members_start_around_the_linear_estimate(setting):
    _, seen, _, case = setting
    filtered = FILTER.fit(seen, case)
    first = filtered.first_members(seen[:2, 0].T).reshape(KOLMOGOROV.dimension, 12, 2)
    np.testing.assert_allclose(first.mean(axis=1), case.maps.estimates(seen[:2, 0, :-1].T))
    errors = case.maps.error_covariance(filtered.errors[:-1])
    variances = np.linalg.eigvalsh(errors)[::-1]
    assert np.cov(first[..., 0]).trace() == pytest.approx(variances[:6].sum())


def test_an_ensemble_of_full_size_finds_components_that_are_hidden():
    """Seven modes of the shear flow, and its energy, tell the two others better than the noise."""
    flow = MoehlisFaisstEckhardt(400.0)
    names = [f"a{number}" for number in range(1, 8)]
    start = np.array([1.0, 0.0, 0.07066, -0.07076, *5 * [0.0]])[:, np.newaxis]
    start = start + 0.01 * np.random.default_rng(3).normal(size=(9, 6))
    states = integrate(flow, start, 0.25, 2400, 4)[-400:].transpose(2, 0, 1)
    seen, channels, case = encoded(flow, {"components": names}, states, 0.25, 4, 61)
    np.testing.assert_array_equal(channels.case.readings_of_series(states), states[..., :7])
    filtered = FilteredEquations(noise=0.01, members=40, inflation=1.02).fit(seen, case)
    error = filtered.start(seen[:, 100:130].transpose(1, 2, 0)) - states[:, 129].T
    share = np.abs(error).mean(axis=1) / states.std(axis=(0, 1))
    assert (share[:7] < 0.01).all()
    assert (share[7:] < 0.05).all()
    for wrong in (["a1", "a1"], ["a10"]):
        with pytest.raises(ValueError, match=r"components must be some of a1, a2, .*, each once"):
            encoding_case(flow, {"components": wrong}, {})
