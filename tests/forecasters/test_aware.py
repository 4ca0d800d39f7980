"""Kinds that learn how the flow depends on a parameter, and are told its values."""

from dataclasses import replace

import numpy as np
import pytest

from burstcast.data.parameter_factors import ParameterFactors
from burstcast.esn.dynamics import Dynamics
from burstcast.esn.network import EchoStateNetwork
from burstcast.esn.reservoir import ReservoirSeed
from burstcast.esn.training import train
from burstcast.forecasters._options import options_of_kind
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.equations_noisy import EquationsFromObservation
from burstcast.forecasters.esn_aware import AwareNetworkForecaster, factored_training
from burstcast.forecasters.quadratic_aware import AwareQuadraticModel
from burstcast.forecasters.quadratic_aware_filtered import FilteredAwareQuadraticModel
from burstcast.forecasters.registry import (
    all_kinds,
    available_kinds,
    forecaster_class,
    learns_parameters,
)
from burstcast.polynomials.basis import monomials
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.parameters import SystemParameters, integrate_scheduled
from burstcast.tuning.hyperparameters import SearchSpace
from burstcast.tuning.network_search import best, search
from burstcast.tuning.scan import scan
from burstcast.tuning.strategies.base import ValidationPlan
from burstcast.tuning.strategies.registry import make_strategy
from burstcast.tuning.validation import PointValidator

RHO = SystemParameters.of(Lorenz63(), ["rho"])
OPTIONS = {**options_of_kind("quadratic_aware_filtered"), "transform": "identity"}
CASE = ForecastingCase(Lorenz63(), 0.0025, 8, 50, OPTIONS, RHO)
TRAINED, WASHOUT, AHEAD = (25.0, 28.0, 32.0), 30, 60


def states(batch, seed):
    return np.random.default_rng(seed).normal(size=(3, batch)) + np.array([[1.0], [1.0], [25.0]])


def noisy(true, seed):
    noise = 1e-3 * true.std(axis=(0, 2))[:, np.newaxis]
    return true + noise * np.random.default_rng(seed).standard_normal(true.shape)


@pytest.fixture(scope="module")
def training():
    """Four series at each of three values: observed ``(series, time, 3)``, and their schedules."""
    true = np.concatenate(
        [
            integrate(Lorenz63(rho=one), states(4, int(one)), 0.0025, 8 * 1600, 8)[100:]
            for one in TRAINED
        ],
        axis=2,
    )
    values = np.repeat(TRAINED, 4)[:, np.newaxis, np.newaxis]
    return noisy(true, 1).transpose(2, 0, 1), np.repeat(values, len(true) - 1, axis=1)


@pytest.fixture(scope="module")
def switched():
    """Test flows whose parameter switches between values that training has not seen."""
    generator = np.random.default_rng(11)
    changes = generator.random((WASHOUT - 1 + AHEAD, 20)) < 0.1
    schedule = np.array([26.5, 30.0])[np.cumsum(changes, axis=0) % 2][:, np.newaxis]
    start = integrate(Lorenz63(), states(20, 5), 0.0025, 4000, 4000)[-1]
    true = integrate_scheduled(RHO, schedule, start, 0.0025, 8)
    return schedule, true, noisy(true, 2)


@pytest.fixture(scope="module")
def models(training):
    kinds = (AwareQuadraticModel, FilteredAwareQuadraticModel)
    return {kind: kind.fit(training[0], CASE, training[1]) for kind in kinds}


def forecast(model, washout, past=None, ahead=None, steps=AHEAD):
    return model.advance(model.start(washout, past), steps, ahead)[0]


def test_kinds_that_need_schedules_are_found_by_name_but_not_offered():
    kinds = {kind for kind in all_kinds() if learns_parameters(kind)}
    assert kinds == {"esn_aware", "quadratic_aware", "quadratic_aware_filtered"}
    assert not kinds & {*available_kinds()}
    assert forecaster_class("quadratic_aware") is AwareQuadraticModel


def test_the_term_with_the_parameter_is_found(models):
    model = models[AwareQuadraticModel]
    basis = monomials(3, 2)
    assert np.argwhere(model.coefficients[1]).tolist() == [[basis.index((0,)), 1]]
    assert model.coefficients[1, basis.index((0,)), 1] == pytest.approx(3.5, rel=0.01)


@pytest.mark.parametrize("kind", [AwareQuadraticModel, FilteredAwareQuadraticModel])
def test_forecasts_under_unseen_values_are_nearly_those_of_the_equations(kind, models, switched):
    schedule, true, observed = switched
    past, ahead = schedule[: WASHOUT - 1], schedule[WASHOUT - 1 :]
    error = forecast(models[kind], observed[:WASHOUT], past, ahead) - true[WASHOUT:]
    equations = EquationsFromObservation.fit(observed.transpose(2, 0, 1), CASE)
    bound = forecast(equations, observed[:WASHOUT], past, ahead) - true[WASHOUT:]
    scale = true.std(axis=(0, 2))[:, np.newaxis]
    typical = np.median(np.abs(error / scale).mean(axis=(0, 1)))
    assert typical < 1.5 * np.median(np.abs(bound / scale).mean(axis=(0, 1)))
    untold = forecast(models[kind], observed[:WASHOUT]) - true[WASHOUT:]
    assert np.median(np.abs(untold / scale).mean(axis=(0, 1))) > 4 * typical


def test_a_filter_that_is_told_estimates_better_than_an_observation(models, switched):
    schedule, true, observed = switched
    model, past = models[FilteredAwareQuadraticModel], schedule[: WASHOUT - 1]
    now = true[WASHOUT - 1]
    told = np.sqrt(np.mean((model.start(observed[:WASHOUT], past) - now) ** 2))
    assert told < 0.6 * np.sqrt(np.mean((observed[WASHOUT - 1] - now) ** 2))
    assert told < 0.3 * np.sqrt(np.mean((model.start(observed[:WASHOUT]) - now) ** 2))


@pytest.mark.parametrize("kind", [AwareQuadraticModel, FilteredAwareQuadraticModel])
def test_forecasts_do_not_depend_on_their_batch_nor_on_pauses(kind, models, switched):
    schedule, _, observed = switched
    past, ahead = schedule[: WASHOUT - 1], schedule[WASHOUT - 1 :]
    model = models[kind]
    together = forecast(model, observed[:WASHOUT], past, ahead)
    for flow in (0, 7):
        one = slice(flow, flow + 1)
        alone = forecast(model, observed[:WASHOUT, :, one], past[..., one], ahead[..., one])
        assert np.array_equal(alone[..., 0], together[..., flow])
    memory = model.start(observed[:WASHOUT], past)
    first, memory = model.advance(memory, 17, ahead[:17])
    second, _ = model.advance(memory, AHEAD - 17, ahead[17:])
    assert np.array_equal(np.concatenate([first, second]), together)


def test_the_observable_is_that_of_the_states(models):
    model = models[AwareQuadraticModel]
    state = np.random.default_rng(1).normal(size=(4, 5))
    assert np.array_equal(model.system.observable(state), CASE.system.observable(state[:3]))


def test_perturbations_grow_as_differences_do(models):
    model = models[AwareQuadraticModel]
    memory = states(4, 9)
    tangent = np.random.default_rng(2).normal(size=(3, 2, 4))
    there, grown = model.advance_tangent(memory, tangent, 10)
    assert np.array_equal(there, model.advance(memory, 10)[1])
    for number in range(2):
        ahead = model.advance(memory + 1e-6 * tangent[:, number], 10)[1]
        behind = model.advance(memory - 1e-6 * tangent[:, number], 10)[1]
        np.testing.assert_allclose(grown[:, number], (ahead - behind) / 2e-6, rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize("kind", [AwareQuadraticModel, FilteredAwareQuadraticModel])
def test_restored_from_its_record_it_forecasts_the_same_bits(kind, models, switched):
    schedule, _, observed = switched
    past, ahead = schedule[: WASHOUT - 1], schedule[WASHOUT - 1 :]
    restored = kind.restore(models[kind].record(), CASE)
    expected = forecast(models[kind], observed[:WASHOUT], past, ahead)
    assert np.array_equal(forecast(restored, observed[:WASHOUT], past, ahead), expected)


def test_a_series_left_out_takes_its_schedule_along(training):
    observed, schedules = training
    case = replace(CASE, options={**OPTIONS, "significance": 0})
    model = AwareQuadraticModel.fit(observed, case, schedules)
    refitted = next(model.leave_one_out(observed, case, 20, schedules))
    expected = AwareQuadraticModel.fit(observed[1:], case, schedules[1:])
    np.testing.assert_allclose(refitted.coefficients, expected.coefficients, rtol=1e-4, atol=1e-6)


def test_the_degree_in_the_parameter_is_an_option(training, switched):
    observed, schedules = training
    case = replace(CASE, options={**OPTIONS, "parameter_degree": 2})
    model = AwareQuadraticModel.fit(observed, case, schedules)
    assert model.coefficients.shape[0] == 3
    assert not model.coefficients[2].any()
    schedule, _, now = switched
    assert np.isfinite(forecast(model, now[:WASHOUT], None, schedule[WASHOUT - 1 :])).all()


def test_what_it_looks_like(models):
    assert repr(models[AwareQuadraticModel]) == (
        "AwareQuadraticModel(7 + 1 terms of 3 components, by rho)"
    )


@pytest.mark.parametrize("kind", [AwareQuadraticModel, FilteredAwareQuadraticModel])
def test_training_that_does_not_tell_the_parameter_is_refused(kind, training):
    observed, schedules = training
    with pytest.raises(ValueError, match="rho does not vary in training"):
        kind.fit(observed, CASE)
    with pytest.raises(ValueError, match="rho does not vary in training"):
        kind.fit(observed, CASE, np.full_like(schedules, 28.0))
    with pytest.raises(ValueError, match="a case that has some"):
        kind.fit(observed, replace(CASE, parameters=None), schedules)


def test_values_beyond_training_are_extrapolated_with_a_warning(models, switched):
    _, _, observed = switched
    model = models[AwareQuadraticModel]
    assert isinstance(model.factors, ParameterFactors)
    with pytest.warns(UserWarning, match="rho = 40 lies outside of the values in training, 25 to"):
        model.advance(observed[0], 3, RHO.constant(3, 20, [40.0]))


@pytest.fixture(scope="module")
def network(training):
    observed, schedules = training
    options = {**options_of_kind("esn_aware"), "transform": "identity"}
    case = replace(CASE, options=options)
    seed = ReservoirSeed(1, 200, 0, 3.0, 0.1)
    series, factors = factored_training(observed, np.ptp(observed, axis=(0, 1)), schedules, case)
    dynamics = Dynamics(seed.reservoir(3), 0.2, 1.0)
    readout = train(dynamics, series, washout=WASHOUT, tikhonov=1e-9)
    trained = EchoStateNetwork(dynamics, readout, series.input_range)
    return case, AwareNetworkForecaster(trained, seed, 10.0, factors, RHO)


def test_a_network_that_is_told_forecasts_under_unseen_values(network, switched):
    _, model = network
    schedule, true, observed = switched
    past, ahead = schedule[: WASHOUT - 1], schedule[WASHOUT - 1 :]
    scale = true.std(axis=(0, 2))[:, np.newaxis]

    def typical(outputs):
        error = np.abs((outputs - true[WASHOUT:]) / scale)[:30]
        return np.median(error.mean(axis=(0, 1)))

    told = typical(forecast(model, observed[:WASHOUT], past, ahead))
    assert told < 0.05
    assert typical(forecast(model, observed[:WASHOUT])) > 3 * told
    # the washout needs no schedule: one memory serves all plans
    assert np.array_equal(model.start(observed[:WASHOUT], past), model.start(observed[:WASHOUT]))


def test_a_network_under_the_case_s_own_values_is_a_plain_one(network, switched):
    _, model = network
    _, _, observed = switched
    plain = model.network.under(model.factors(np.array([[28.0]]))[0])
    memory = model.start(observed[:WASHOUT])
    assert np.array_equal(model.advance(memory, 40)[0], plain.forecast(memory, 40)[0])
    tangent = np.random.default_rng(1).normal(size=(200, 1, 20))
    there, grown = model.advance_tangent(memory, tangent, 3)
    assert np.array_equal(there, model.advance(memory, 3)[1])
    ahead = model.advance(memory + 1e-6 * tangent[:, 0], 3)[1]
    behind = model.advance(memory - 1e-6 * tangent[:, 0], 3)[1]
    np.testing.assert_allclose(grown[:, 0], (ahead - behind) / 2e-6, rtol=1e-3, atol=1e-6)


def test_a_network_is_restored_and_refitted_with_its_factors(network, training, switched):
    case, model = network
    observed, schedules = training
    schedule, _, now = switched
    restored = AwareNetworkForecaster.restore(model.record(), case)
    ahead = schedule[WASHOUT - 1 :]
    expected = forecast(model, now[:WASHOUT], None, ahead)
    assert np.array_equal(forecast(restored, now[:WASHOUT], None, ahead), expected)
    refitted = next(model.leave_one_out(observed, case, WASHOUT, schedules))
    others, _ = factored_training(observed[1:], model.network.input_range, schedules[1:], case)
    readout = train(model.network.dynamics, others, washout=WASHOUT, tikhonov=1e-9)
    outputs, _ = refitted.network.under(np.zeros(1)).forecast(model.start(now[:WASHOUT]), 5)
    alone = replace(model.network, readout=readout).under(np.zeros(1))
    np.testing.assert_allclose(outputs, alone.forecast(model.start(now[:WASHOUT]), 5)[0], atol=1e-3)
    with pytest.raises(ValueError, match="have schedules"):
        next(model.leave_one_out(observed, case, WASHOUT))
    assert repr(model).endswith("by rho)")


def test_the_search_of_a_network_is_that_of_plain_ones(training):
    """The workflow's own search on series with factors: a network comes out that uses them."""
    observed, schedules = training
    case = replace(CASE, options={**options_of_kind("esn_aware"), "transform": "identity"})
    series, _ = factored_training(
        observed[:, :400], np.ptp(observed, axis=(0, 1)), schedules[:, :399], case
    )
    seed = ReservoirSeed(1, 60, 0, 3.0, 0.1)
    plan = ValidationPlan(washout=20, interval=40, series=12, intervals=2)
    validator = PointValidator(
        seed.reservoir(3), series, lambda state: state[0], plan, [1e-9, 1e-6], "compiled"
    )
    space, strategy = SearchSpace((0.05, 1.0), (0.2, 2.0)), make_strategy("RV")
    found = best(search(validator, space, strategy, scan(validator, space, [strategy], 2), 1, 3))
    dynamics, tikhonov = validator.dynamics(found.point), found.validation.tikhonov
    readout = train(dynamics, series, washout=20, tikhonov=tikhonov)
    assert len(readout.weights) > 2 * 60 - 10
    assert np.isfinite(found.objective)
