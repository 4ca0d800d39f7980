"""Kinds that learn how the flow depends on a parameter; schedules; columns known in advance."""

from dataclasses import replace

import numpy as np
import pytest

from burstcast.base.exogenous import carry, of_memory, of_washout, with_inputs
from burstcast.forecasters._event_classifier import LabelledPoints
from burstcast.forecasters._parameter_factors import factored_training
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.equations import EquationsFromTruth
from burstcast.forecasters.equations_filtered import FilteredEquations
from burstcast.forecasters.equations_noisy import EquationsFromObservation
from burstcast.forecasters.esn_aware import AwareNetworkForecaster
from burstcast.forecasters.quadratic_aware import AwareQuadraticModel
from burstcast.forecasters.quadratic_aware_filtered import FilteredAwareQuadraticModel
from burstcast.forecasters.registry import make_kind
from burstcast.forecasts.horizon import HorizonSearch, prediction_horizons
from burstcast.forecasts.windows import window_forecasts
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.factored import network_under
from burstcast.networks.reservoir import ReservoirSeed
from burstcast.networks.training import TrainingSeries, train
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.measured import MeasuredSeries
from burstcast.systems.parameters import Parameters, SystemParameters, integrate_scheduled
from burstcast.systems.polynomials.basis import monomials
from helpers_library import (
    MadeUpForecaster,
    assert_depends_on_its_washout_alone,
    assert_perturbations_grow_as_differences,
    lorenz_states,
)

RHO = SystemParameters.of(Lorenz63(), ["rho"])
CASE = ForecastingCase(Lorenz63(), 0.0025, 8, 50, RHO)
LEARNT = AwareQuadraticModel(transform="identity")
FILTERED = FilteredAwareQuadraticModel(transform="identity")
NETWORK = AwareNetworkForecaster(transform="identity")
PLAIN = replace(CASE, parameters=None)
TRAINED, WASHOUT, AHEAD = (25.0, 28.0, 32.0), 30, 60


def noisy(true, seed):
    noise = 1e-3 * true.std(axis=(0, 2))[:, np.newaxis]
    return true + noise * np.random.default_rng(seed).standard_normal(true.shape)


@pytest.fixture(scope="module")
def training():
    """Four series at each of three values, observed, with the values: ``(series, time, 4)``."""
    flows = [
        integrate(Lorenz63(rho=rho), lorenz_states(4, int(rho)), 0.0025, 8 * 1600, 8)
        for rho in TRAINED
    ]
    true = np.concatenate(flows, axis=2)[100:]
    values = np.repeat(TRAINED, 4)[:, np.newaxis, np.newaxis]
    return with_inputs(noisy(true, 1).transpose(2, 0, 1), np.repeat(values, len(true) - 1, axis=1))


@pytest.fixture(scope="module")
def switched():
    """Test flows whose parameter switches between values that training has not seen."""
    generator = np.random.default_rng(11)
    changes = generator.random((WASHOUT - 1 + AHEAD, 20)) < 0.1
    schedule = np.array([26.5, 30.0])[np.cumsum(changes, axis=0) % 2][:, np.newaxis]
    start = integrate(Lorenz63(), lorenz_states(20, 5), 0.0025, 4000, 4000)[-1]
    true = integrate_scheduled(RHO, schedule, start, 0.0025, 8)
    return schedule, true, noisy(true, 2)


@pytest.fixture(scope="module")
def models(training):
    return {type(model): model.fit(training, CASE) for model in (LEARNT, FILTERED)}


def washout_under(washout, schedule):
    """Washout with its schedule, and the one over the forecast: the batch is last in all."""
    inputs = schedule.transpose(2, 0, 1)
    return with_inputs(washout.transpose(2, 0, 1), inputs).transpose(1, 2, 0)


def forecast(model, washout, schedule=None, steps=AHEAD):
    if schedule is not None:
        washout = washout_under(washout, schedule)
    return model.advance(model.start(washout), steps)[0]


def test_the_term_with_the_parameter_is_found_and_told(models):
    model = models[AwareQuadraticModel]
    basis = monomials(3, 2)
    assert np.argwhere(model.coefficients[1]).tolist() == [[basis.index((0,)), 1]]
    assert model.coefficients[1, basis.index((0,)), 1] == pytest.approx(3.5, rel=0.01)
    state = np.random.default_rng(1).normal(size=(4, 5))
    assert np.array_equal(model.system.observable(state), CASE.system.observable(state[:3]))
    assert repr(model) == "AwareQuadraticModel(7 + 1 terms of 3 components, by rho)"


def typical_error(outputs, true):
    """Median over flows of the error, in standard deviations of the components."""
    scale = true.std(axis=(0, 2))[:, np.newaxis]
    return np.median(
        np.abs((outputs - true[WASHOUT : WASHOUT + len(outputs)]) / scale).mean((0, 1))
    )


@pytest.mark.parametrize("kind", [AwareQuadraticModel, FilteredAwareQuadraticModel])
def test_forecasts_under_unseen_values_are_nearly_those_of_the_equations(kind, models, switched):
    schedule, true, observed = switched
    equations = EquationsFromObservation().fit(observed.transpose(2, 0, 1), CASE)
    typical, bound = (
        typical_error(forecast(model, observed[:WASHOUT], schedule), true)
        for model in (models[kind], equations)
    )
    assert typical < 1.5 * bound
    assert typical_error(forecast(models[kind], observed[:WASHOUT]), true) > 4 * typical


@pytest.mark.parametrize("kind", [FilteredAwareQuadraticModel, FilteredEquations])
def test_a_filter_that_is_told_estimates_better_than_an_observation(kind, models, switched):
    """Not told, it trusts a flow under other parameters."""
    schedule, true, observed = switched
    model = models.get(kind)
    if model is None:  # with an inflation that is chosen, it would trust it less
        model = kind(inflation=1.0).fit(observed.transpose(2, 0, 1), CASE)
    now, washout = true[WASHOUT - 1], observed[:WASHOUT]
    estimate = model.start(washout_under(washout, schedule[: WASHOUT - 1]))
    error = np.sqrt(np.mean((estimate - now) ** 2))
    assert error < 0.6 * np.sqrt(np.mean((washout[-1] - now) ** 2))
    assert error < 0.3 * np.sqrt(np.mean((model.start(washout) - now) ** 2))


EQUATIONS = (EquationsFromTruth, EquationsFromObservation, FilteredEquations)


@pytest.fixture(
    params=[AwareQuadraticModel, FilteredAwareQuadraticModel, AwareNetworkForecaster, *EQUATIONS],
    ids=lambda kind: kind.__name__,
)
def scheduled(request, models, network, training):
    """A forecaster of each kind that uses a schedule."""
    if request.param is AwareNetworkForecaster:
        return network
    return models.get(request.param) or request.param().fit(training[..., :3], CASE)


def test_forecasts_under_a_schedule_depend_on_nothing_else(scheduled, switched):
    model, (schedule, _, observed) = scheduled, switched
    washout, past, ahead = observed[:WASHOUT], schedule[: WASHOUT - 1], schedule[WASHOUT - 1 :]
    told = washout_under(washout, schedule)
    whole = assert_depends_on_its_washout_alone(model, told, AHEAD, CASE)
    assert not np.array_equal(forecast(model, washout), whole)
    # without a schedule, the case's own values are in force
    expected = forecast(model, washout, RHO.constant(WASHOUT - 1 + AHEAD, 20))
    np.testing.assert_allclose(forecast(model, washout), expected, rtol=0, atol=1e-6)
    # as well in a memory that has no schedule yet
    first, memory = model.advance(carry(model.start(washout_under(washout, past)), ahead[:17]), 17)
    second, _ = model.advance(carry(memory, ahead[17:]), AHEAD - 17)
    assert np.array_equal(np.concatenate([first, second]), whole)


def test_perturbations_grow_as_differences_do(models, network, switched):
    for model in (models[AwareQuadraticModel], network):
        assert_perturbations_grow_as_differences(model, model.start(switched[2][:WASHOUT]))


def test_the_degree_in_the_parameter_is_an_option(training):
    model = replace(LEARNT, parameter_degree=2).fit(training, CASE)
    assert model.coefficients.shape[0] == 3
    assert not model.coefficients[2].any()


@pytest.mark.parametrize("kind", [LEARNT, FILTERED], ids=lambda kind: type(kind).__name__)
def test_training_that_does_not_tell_the_parameter_is_refused(kind, training):
    observed, constant = training[..., :3], training.copy()
    constant[..., 3] = 28.0
    for series in (observed, constant):
        with pytest.raises(ValueError, match="rho does not vary in training"):
            kind.fit(series, CASE)
    with pytest.raises(ValueError, match="a case that has some"):
        kind.fit(training, replace(CASE, parameters=None))


def test_values_beyond_training_are_extrapolated_with_a_warning(models, switched):
    with pytest.warns(UserWarning, match="rho = 40 lies outside of the values in training, 25 to"):
        models[AwareQuadraticModel].advance(carry(switched[2][0], RHO.constant(3, 20, [40.0])), 3)


@pytest.fixture(scope="module")
def network(training):
    seed = ReservoirSeed(1, 200, 0, 3.0, 0.1)
    plain = TrainingSeries(training, np.ptp(training[..., :3], axis=(0, 1)))
    series = factored_training(plain, RHO, NETWORK)
    dynamics = Dynamics(seed.reservoir(3), 0.2, 1.0)
    return NETWORK.trained(
        dynamics, seed, series, washout=WASHOUT, tikhonov=1e-9, steps_per_lyapunov_time=61
    )


def test_a_network_that_is_told_forecasts_under_unseen_values(network, switched):
    schedule, true, observed = switched
    washout = observed[:WASHOUT]
    error = typical_error(forecast(network, washout, schedule, 30), true)
    assert error < 0.05
    assert typical_error(forecast(network, washout, steps=30), true) > 3 * error
    # the washout needs no schedule: one memory serves all plans
    past = schedule[: WASHOUT - 1]
    assert np.array_equal(network.start(washout_under(washout, past)), network.start(washout))


def test_a_network_is_refitted_with_its_factors(network, training, switched):
    trained, memory = network.network, network.start(switched[2][:WASHOUT])
    refitted = next(network.leave_one_out(training, CASE, WASHOUT)).network
    others = TrainingSeries(training[1:], trained.input_range)
    factored = factored_training(others, RHO, NETWORK)
    readout = train(trained.dynamics, factored, washout=WASHOUT, tikhonov=1e-9)
    outputs, expected = (
        network_under(each, np.zeros(1)).forecast(memory, 5)[0]
        for each in (refitted, replace(trained, readout=readout))
    )
    np.testing.assert_allclose(outputs, expected, atol=1e-3)
    with pytest.raises(ValueError, match="have inputs"):
        next(network.leave_one_out(training[..., :3], CASE, WASHOUT))
    assert repr(network).endswith("by rho)")


# -- schedules, of kinds that use them and of all others -------------------------------------------


def test_the_equations_told_of_the_schedule_forecast_perfectly(switched):
    schedule, true, _ = switched
    model = EquationsFromTruth().fit(np.empty((0, 2, 3)), CASE)
    assert np.array_equal(forecast(model, true[:WASHOUT], schedule), true[WASHOUT:])
    assert not np.allclose(forecast(model, true[:WASHOUT]), true[WASHOUT:], atol=0.05)
    with pytest.raises(ValueError, match="inputs over 19 steps are given, but 20 are forecast"):
        model.advance(carry(true[0], schedule[:19]), 20)
    plain = EquationsFromTruth().fit(np.empty((0, 2, 3)), PLAIN)
    with pytest.raises(ValueError, match="the case has no parameters"):
        plain.advance(carry(true[0], schedule[:20]), 20)


def test_members_have_the_schedule_of_their_own_trajectory(switched):
    """Of a whole ensemble side by side, or of each trajectory by itself."""
    schedule, _, observed = switched
    model = FilteredEquations().fit(observed.transpose(2, 0, 1), CASE)
    told = washout_under(observed[:WASHOUT], schedule)
    ensemble = model.ensemble(told)
    together, _ = model.advance(ensemble.reshape(len(ensemble), -1), AHEAD)
    together = together.reshape(AHEAD, 3, -1, 20)
    for flow in range(3):
        members = model.ensemble(np.ascontiguousarray(told[..., [flow]]))
        assert np.array_equal(members[..., 0], ensemble[..., flow])
        alone, _ = model.advance(np.ascontiguousarray(members[..., 0]), AHEAD)
        assert np.array_equal(alone, together[..., flow])
        single = model.combined(members)[:, 0]
        assert np.array_equal(single[3:], schedule[WASHOUT - 1 :, 0, flow])
        np.testing.assert_allclose(single[:3], members[:3, :, 0].mean(axis=1))


# -- columns of a record that are known in advance -------------------------------------------------
SPACE = MeasuredSeries(("x", "y", "z"), "z")
# what is known of rho in a record: its column, and no value of the case's own
MEASURED = replace(CASE, system=SPACE, parameters=Parameters(("rho",), ()))


@pytest.fixture(scope="module")
def simulated():
    """States ``(6, time, 3)`` under a parameter that changes now and then, and its schedule."""
    generator = np.random.default_rng(4)
    changes = generator.random((800, 6)) < 0.05
    schedule = np.array([24.0, 28.0, 33.0])[np.cumsum(changes, axis=0) % 3][:, np.newaxis]
    start = generator.normal(size=(3, 6)) + np.array([[1.0], [1.0], [25.0]])
    states = integrate_scheduled(RHO, schedule, start, 0.0025, 8)
    return tuple(np.ascontiguousarray(array.transpose(2, 0, 1)) for array in (states, schedule))


def trained(kind, case, states, schedules):
    if kind == "quadratic_aware":
        return LEARNT.fit(with_inputs(states, schedules), case)
    seed = ReservoirSeed(1, 60, 0, 4, 0.1)
    plain = TrainingSeries(with_inputs(states, schedules), np.ptp(states, axis=(0, 1)))
    series = factored_training(plain, case.parameters, NETWORK)
    dynamics = Dynamics(seed.reservoir(3), 0.3, 0.5, "scipy")
    return NETWORK.trained(
        dynamics, seed, series, washout=20, tikhonov=1e-9, steps_per_lyapunov_time=61
    )


@pytest.mark.parametrize("kind", ["quadratic_aware", "esn_aware"])
def test_forecasts_of_a_record_are_those_of_the_simulated_case(simulated, kind):
    states, schedules = simulated
    simulated_model, measured_model = (
        trained(kind, case, states[:4], schedules[:4]) for case in (CASE, MEASURED)
    )
    for name, array in simulated_model.record().arrays.items():
        np.testing.assert_array_equal(measured_model.record().arrays[name], array, err_msg=name)
    starts = [(row, step) for row in (4, 5) for step in range(40, 700, 60)]
    washouts = np.stack([states[row, step - 29 : step + 1] for row, step in starts])
    in_force = np.stack([schedules[row, step - 29 : step + 60] for row, step in starts])

    def largest(model, washouts):
        return window_forecasts(model, SPACE.observable, washouts, (20, 40, 60)).largest

    given = with_inputs(washouts, in_force)
    expected = largest(simulated_model, given)
    # a batch, and one after the other
    np.testing.assert_array_equal(largest(measured_model, given), expected)
    alone = np.concatenate([largest(measured_model, given[[row]]) for row in range(len(starts))])
    np.testing.assert_allclose(alone, expected, rtol=1e-9)
    # the forecast of another future is another one, and of none there is none
    in_force[:, 29:] = 24.0
    assert not np.array_equal(largest(measured_model, with_inputs(washouts, in_force)), expected)
    with pytest.raises(ValueError, match="rho: values over the whole forecast must be given"):
        largest(measured_model, washouts)


class Driven(MadeUpForecaster):
    """Each step adds the value in force; nothing is learnt."""

    aware = True

    def start(self, washout):
        states, schedule, ahead = of_washout(washout, 1)
        # the washout's own values must be those of the same steps
        np.testing.assert_allclose(np.diff(states, axis=0), schedule, atol=1e-12)
        return carry(states[-1], ahead)

    def advance(self, memory, steps):
        state, schedule, later = of_memory(memory, 1, 1, steps)
        outputs = state + np.cumsum(schedule, axis=0)
        return outputs, carry(outputs[-1], later)


def test_horizons_under_a_schedule_end_where_it_is_wrong():
    search = HorizonSearch(4.0, 1.0, 0.5, washout=5, steps_per_lyapunov_time=10)
    generator = np.random.default_rng(3)
    schedules = generator.normal(size=(700, search.steps_before_event, 1))
    truth = np.concatenate([np.zeros((700, 1)), np.cumsum(schedules[..., 0], axis=1)], axis=1)
    observed = truth[..., np.newaxis].copy()

    def horizons(in_force):
        series = with_inputs(observed, in_force)
        return prediction_horizons(Driven(), lambda states: states[0], series, truth, search, 1)

    np.testing.assert_array_equal(horizons(schedules), 4.0)
    wrong = schedules.copy()
    wrong[:, -15] += 1.0  # 15 steps before the event: only later starts do not pass it
    np.testing.assert_array_equal(horizons(wrong), 1.0)


@pytest.mark.parametrize(
    ("kind", "options"),
    [
        ("precursor", {"lags_lt": [], "classifier": "logistic"}),
        ("esn_direct", {"penalty": [1], "neurons": 40, "connectivity": 3}),
    ],
)
def test_classifiers_learn_from_what_is_known(kind, options):
    generator = np.random.default_rng(5)
    washouts, exogenous = generator.normal(size=(1500, 3, 2)), generator.normal(size=(1500, 2))
    happened = (exogenous[:, 1] + washouts[:, -1, 0] > 1.5)[:, np.newaxis]
    series, case = np.arange(1500) // 150, replace(CASE, random_seed=1)
    later, classifier, scores = series >= 7, make_kind(kind, options), []
    for features in (None, exogenous):
        points = LabelledPoints(washouts, happened, series, features).of(~later, np.array([True]))
        fitted = classifier.fit(points, case)
        asked = washouts[later], None if features is None else features[later]
        chance = fitted.probabilities(*asked)[:, 0]
        assert ((chance > 0) & (chance < 1)).all()
        scores.append(np.mean((chance - happened[later, 0]) ** 2))
        again = classifier.restore(fitted.record(), case).probabilities(*asked)[:, 0]
        np.testing.assert_array_equal(again, chance)
    assert scores[1] < 0.5 * scores[0]
