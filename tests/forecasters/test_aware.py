"""Kinds that learn how the flow depends on a parameter; schedules; columns known in advance."""

from dataclasses import replace

import numpy as np
import pytest

from burstcast.control.actuation import ActuatorShare
from burstcast.data.records import recorded_series
from burstcast.forecasters._event_classifier import LabelledPoints
from burstcast.forecasters._parameter_factors import ParameterFactors
from burstcast.forecasters.analogues import Analogues
from burstcast.forecasters.base import ForecastingCase, for_members
from burstcast.forecasters.equations import EquationsFromTruth
from burstcast.forecasters.equations_filtered import FilteredEquations
from burstcast.forecasters.equations_noisy import EquationsFromObservation
from burstcast.forecasters.esn_aware import AwareNetworkForecaster, factored_training
from burstcast.forecasters.linear_inverse import LinearInverseModel
from burstcast.forecasters.nvar import NVAR
from burstcast.forecasters.persistence import Persistence
from burstcast.forecasters.quadratic import QuadraticModel
from burstcast.forecasters.quadratic_aware import AwareQuadraticModel
from burstcast.forecasters.quadratic_aware_filtered import FilteredAwareQuadraticModel
from burstcast.forecasters.quadratic_filtered import FilteredQuadraticModel
from burstcast.forecasters.registry import (
    all_kinds,
    available_kinds,
    kind_class,
    make_classifier,
)
from burstcast.forecasts.horizon import HorizonSearch, prediction_horizons
from burstcast.forecasts.window_forecasts import window_forecasts
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.network import EchoStateNetwork
from burstcast.networks.reservoir import ReservoirSeed
from burstcast.networks.training import TrainingSeries, train
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.measured import MeasuredSeries
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.parameters import Parameters, SystemParameters, integrate_scheduled
from burstcast.systems.polynomials.basis import monomials
from helpers_library import MadeUpForecaster

RHO = SystemParameters.of(Lorenz63(), ["rho"])
CASE = ForecastingCase(Lorenz63(), 0.0025, 8, 50, RHO)
LEARNT = AwareQuadraticModel(transform="identity")
FILTERED = FilteredAwareQuadraticModel(transform="identity")
NETWORK = AwareNetworkForecaster(transform="identity")
PLAIN = replace(CASE, parameters=None)
TRAINED, WASHOUT, AHEAD = (25.0, 28.0, 32.0), 30, 60


def states(batch, seed):
    return np.random.default_rng(seed).normal(size=(3, batch)) + np.array([[1.0], [1.0], [25.0]])


def noisy(true, seed):
    noise = 1e-3 * true.std(axis=(0, 2))[:, np.newaxis]
    return true + noise * np.random.default_rng(seed).standard_normal(true.shape)


@pytest.fixture(scope="module")
def training():
    """Four series at each of three values: observed ``(series, time, 3)``, and their schedules."""
    flows = [
        integrate(Lorenz63(rho=one), states(4, int(one)), 0.0025, 8 * 1600, 8) for one in TRAINED
    ]
    true = np.concatenate(flows, axis=2)[100:]
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
    return {type(one): one.fit_under(training[0], CASE, training[1]) for one in (LEARNT, FILTERED)}


def forecast(model, washout, past=None, ahead=None, steps=AHEAD):
    return model.advance_under(model.start_under(washout, past), steps, ahead)[0]


def test_kinds_that_need_schedules_are_found_by_name_but_not_offered():
    kinds = {kind for kind in all_kinds() if kind_class(kind).learns_parameters}
    assert kinds == {"esn_aware", "quadratic_aware", "quadratic_aware_filtered"}
    assert not kinds & {*available_kinds()}
    assert kind_class("quadratic_aware") is AwareQuadraticModel


def test_the_term_with_the_parameter_is_found_and_told(models):
    model = models[AwareQuadraticModel]
    basis = monomials(3, 2)
    assert np.argwhere(model.coefficients[1]).tolist() == [[basis.index((0,)), 1]]
    assert model.coefficients[1, basis.index((0,)), 1] == pytest.approx(3.5, rel=0.01)
    model = models[AwareQuadraticModel]
    state = np.random.default_rng(1).normal(size=(4, 5))
    assert np.array_equal(model.system.observable(state), CASE.system.observable(state[:3]))
    assert repr(models[AwareQuadraticModel]) == (
        "AwareQuadraticModel(7 + 1 terms of 3 components, by rho)"
    )


@pytest.mark.parametrize("kind", [AwareQuadraticModel, FilteredAwareQuadraticModel])
def test_forecasts_under_unseen_values_are_nearly_those_of_the_equations(kind, models, switched):
    schedule, true, observed = switched
    past, ahead = schedule[: WASHOUT - 1], schedule[WASHOUT - 1 :]
    error = forecast(models[kind], observed[:WASHOUT], past, ahead) - true[WASHOUT:]
    equations = EquationsFromObservation().fit(observed.transpose(2, 0, 1), CASE)
    bound = forecast(equations, observed[:WASHOUT], past, ahead) - true[WASHOUT:]
    scale = true.std(axis=(0, 2))[:, np.newaxis]
    typical = np.median(np.abs(error / scale).mean(axis=(0, 1)))
    assert typical < 1.5 * np.median(np.abs(bound / scale).mean(axis=(0, 1)))
    untold = forecast(models[kind], observed[:WASHOUT]) - true[WASHOUT:]
    assert np.median(np.abs(untold / scale).mean(axis=(0, 1))) > 4 * typical


@pytest.mark.parametrize("kind", [FilteredAwareQuadraticModel, FilteredEquations])
def test_a_filter_that_is_told_estimates_better_than_an_observation(kind, models, switched):
    """Not told, it trusts a flow under other parameters."""
    schedule, true, observed = switched
    model = models.get(kind) or kind().fit(observed.transpose(2, 0, 1), CASE)
    past, now = schedule[: WASHOUT - 1], true[WASHOUT - 1]
    told = np.sqrt(np.mean((model.start_under(observed[:WASHOUT], past) - now) ** 2))
    assert told < 0.6 * np.sqrt(np.mean((observed[WASHOUT - 1] - now) ** 2))
    assert told < 0.3 * np.sqrt(np.mean((model.start(observed[:WASHOUT]) - now) ** 2))


EQUATIONS = (EquationsFromTruth, EquationsFromObservation, FilteredEquations)


@pytest.fixture(
    params=[AwareQuadraticModel, FilteredAwareQuadraticModel, AwareNetworkForecaster, *EQUATIONS],
    ids=lambda kind: kind.__name__,
)
def scheduled(request, models, network, training):
    """A forecaster of each kind that uses a schedule, and its case."""
    if request.param is AwareNetworkForecaster:
        return network[1], network[0]
    return models.get(request.param) or request.param().fit(training[0], CASE), CASE


def test_forecasts_under_a_schedule_depend_on_nothing_else(scheduled, switched):
    """Not on their batch, on pauses, nor on having been in a file."""
    model, case = scheduled
    schedule, _, observed = switched
    past, ahead, washout = schedule[: WASHOUT - 1], schedule[WASHOUT - 1 :], observed[:WASHOUT]
    together = forecast(model, washout, past, ahead)
    assert not np.array_equal(forecast(model, washout), together)
    # without schedules, the methods are those of kinds that use none
    plain, _ = model.advance(model.start(washout), AHEAD)
    assert np.array_equal(forecast(model, washout), plain)
    assert np.array_equal(model.ensemble_under(washout, None), model.ensemble(washout))
    for flow in (0, 7):
        one = slice(flow, flow + 1)
        alone = forecast(model, washout[..., one], past[..., one], ahead[..., one])
        assert np.array_equal(alone[..., 0], together[..., flow])
    first, memory = model.advance_under(model.start_under(washout, past), 17, ahead[:17])
    second, _ = model.advance_under(memory, AHEAD - 17, ahead[17:])
    assert np.array_equal(np.concatenate([first, second]), together)
    restored = type(model)(**model.options).restore(model.record(), case)
    assert restored.options == model.options
    assert np.array_equal(forecast(restored, washout, past, ahead), together)


@pytest.mark.parametrize("kind", [AwareQuadraticModel, AwareNetworkForecaster])
def test_perturbations_grow_as_differences_do(kind, models, network, switched):
    model = network[1] if kind is AwareNetworkForecaster else models[kind]
    memory = model.start(switched[2][:WASHOUT])
    tangent = np.random.default_rng(2).normal(size=(len(memory), 2, 20))
    there, grown = model.advance_tangent(memory, tangent, 5)
    assert np.array_equal(there, model.advance(memory, 5)[1])
    for number in range(2):
        ahead = model.advance(memory + 1e-6 * tangent[:, number], 5)[1]
        behind = model.advance(memory - 1e-6 * tangent[:, number], 5)[1]
        np.testing.assert_allclose(grown[:, number], (ahead - behind) / 2e-6, rtol=1e-3, atol=1e-5)


def test_a_series_left_out_takes_its_schedule_along(training):
    observed, schedules = training
    model = LEARNT.fit_under(observed, CASE, schedules)
    refitted = next(model.leave_one_out(observed, CASE, 20, schedules))
    expected = LEARNT.fit_under(observed[1:], CASE, schedules[1:])
    np.testing.assert_allclose(refitted.coefficients, expected.coefficients, rtol=1e-4, atol=1e-6)


def test_the_degree_in_the_parameter_is_an_option(training, switched):
    observed, schedules = training
    model = replace(LEARNT, parameter_degree=2).fit_under(observed, CASE, schedules)
    assert model.coefficients.shape[0] == 3
    assert not model.coefficients[2].any()
    schedule, _, now = switched
    assert np.isfinite(forecast(model, now[:WASHOUT], None, schedule[WASHOUT - 1 :])).all()


@pytest.mark.parametrize("kind", [LEARNT, FILTERED], ids=lambda kind: type(kind).__name__)
def test_training_that_does_not_tell_the_parameter_is_refused(kind, training):
    observed, schedules = training
    with pytest.raises(ValueError, match="rho does not vary in training"):
        kind.fit(observed, CASE)
    with pytest.raises(ValueError, match="rho does not vary in training"):
        kind.fit_under(observed, CASE, np.full_like(schedules, 28.0))
    with pytest.raises(ValueError, match="a case that has some"):
        kind.fit_under(observed, replace(CASE, parameters=None), schedules)


def test_values_beyond_training_are_extrapolated_with_a_warning(models, switched):
    _, _, observed = switched
    model = models[AwareQuadraticModel]
    assert isinstance(model.factors, ParameterFactors)
    with pytest.warns(UserWarning, match="rho = 40 lies outside of the values in training, 25 to"):
        model.advance_under(observed[0], 3, RHO.constant(3, 20, [40.0]))


@pytest.fixture(scope="module")
def network(training):
    observed, schedules = training
    seed = ReservoirSeed(1, 200, 0, 3.0, 0.1)
    scale = np.ptp(observed, axis=(0, 1))
    plain = TrainingSeries(observed, scale)
    series, factors = factored_training(plain, schedules, CASE, NETWORK)
    dynamics = Dynamics(seed.reservoir(3), 0.2, 1.0)
    readout = train(dynamics, series, washout=WASHOUT, tikhonov=1e-9)
    trained = EchoStateNetwork(dynamics, readout, series.input_range)
    return CASE, NETWORK.with_fitted(network=trained, seed=seed, factors=factors, in_force=RHO)


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
    assert np.array_equal(
        model.start_under(observed[:WASHOUT], past), model.start(observed[:WASHOUT])
    )


def test_a_network_under_the_case_s_own_values_is_a_plain_one(network, switched):
    _, model = network
    _, _, observed = switched
    plain = model.network.under(model.factors(np.array([[28.0]]))[0])
    memory = model.start(observed[:WASHOUT])
    assert np.array_equal(model.advance(memory, 40)[0], plain.forecast(memory, 40)[0])


def test_a_network_is_refitted_with_its_factors(network, training, switched):
    case, model = network
    observed, schedules = training
    _, _, now = switched
    refitted = next(model.leave_one_out(observed, case, WASHOUT, schedules))
    scale = model.network.input_range
    others, _ = factored_training(TrainingSeries(observed[1:], scale), schedules[1:], case, NETWORK)
    readout = train(model.network.dynamics, others, washout=WASHOUT, tikhonov=1e-9)
    outputs, _ = refitted.network.under(np.zeros(1)).forecast(model.start(now[:WASHOUT]), 5)
    alone = replace(model.network, readout=readout).under(np.zeros(1))
    np.testing.assert_allclose(outputs, alone.forecast(model.start(now[:WASHOUT]), 5)[0], atol=1e-3)
    with pytest.raises(ValueError, match="have schedules"):
        next(model.leave_one_out(observed, case, WASHOUT))
    assert repr(model).endswith("by rho)")


# -- schedules, of kinds that use them and of all others -------------------------------------------


def test_the_equations_told_of_the_schedule_forecast_perfectly(switched):
    schedule, true, _ = switched
    model = EquationsFromTruth().fit(np.empty((0, 2, 3)), CASE)
    past, ahead = schedule[: WASHOUT - 1], schedule[WASHOUT - 1 :]
    assert np.array_equal(forecast(model, true[:WASHOUT], past, ahead), true[WASHOUT:])
    assert not np.allclose(forecast(model, true[:WASHOUT]), true[WASHOUT:], atol=0.05)
    with pytest.raises(ValueError, match=r"must have the shape \(20, 1, 20\)"):
        model.advance_under(true[0], 20, schedule[:19])
    plain = EquationsFromTruth().fit(np.empty((0, 2, 3)), PLAIN)
    with pytest.raises(ValueError, match="the case has no parameters"):
        plain.advance_under(true[0], 20, schedule[:20])


@pytest.mark.parametrize("kind", [EquationsFromObservation, FilteredEquations])
def test_the_case_s_own_values_are_in_force_without_a_schedule(kind, switched):
    _, _, observed = switched
    training, washout = observed.transpose(2, 0, 1), observed[:WASHOUT]
    own = RHO.constant(WASHOUT - 1, 20), RHO.constant(AHEAD, 20)
    told = forecast(kind().fit(training, CASE), washout, *own)
    assert np.array_equal(told, forecast(kind().fit(training, CASE), washout))
    assert np.array_equal(told, forecast(kind().fit(training, PLAIN), washout))


@pytest.mark.parametrize(
    "kind",
    [Analogues, LinearInverseModel, NVAR, Persistence, QuadraticModel, FilteredQuadraticModel],
)
def test_kinds_that_are_not_aware_ignore_a_schedule(kind, switched):
    schedule, _, observed = switched
    training, washout = observed.transpose(2, 0, 1), observed[:WASHOUT]
    model = kind().fit_under(training, CASE, schedule.transpose(2, 0, 1))
    assert not model.aware
    told = forecast(model, washout, schedule[: WASHOUT - 1], schedule[WASHOUT - 1 :])
    plain = kind().fit(training, PLAIN)
    assert np.array_equal(told, forecast(plain, washout), equal_nan=True)


def test_members_have_the_schedule_of_their_own_trajectory(switched):
    """Of a whole ensemble side by side, or of each trajectory by itself."""
    schedule, _, observed = switched
    model = FilteredEquations().fit(observed.transpose(2, 0, 1), CASE)
    past, ahead = schedule[: WASHOUT - 1], schedule[WASHOUT - 1 :]
    ensemble = model.ensemble_under(observed[:WASHOUT], past)
    number = ensemble.shape[1]
    together, _ = model.advance_under(ensemble.reshape(3, -1), AHEAD, for_members(ahead, number))
    together = together.reshape(AHEAD, 3, -1, 20)
    for one in range(3):
        only = slice(one, one + 1)
        members = model.ensemble_under(observed[:WASHOUT, :, only], past[..., only])
        assert np.array_equal(members[:, :, 0], ensemble[:, :, one])
        start = np.ascontiguousarray(members[..., 0])
        alone, _ = model.advance_under(start, AHEAD, ahead[..., [one] * number])
        assert np.array_equal(alone, together[..., one])


def test_the_share_of_a_force_is_a_parameter_like_any_other():
    flow = MoehlisFaisstEckhardt(400.0)
    share = ActuatorShare.of(flow, {}, [0, 0, 0.01, 0, 0, 0, 0, 0, 0])
    model = EquationsFromTruth().fit(np.empty((0, 2, 9)), ForecastingCase(flow, 0.25, 4, 61, share))
    start = 0.1 * np.ones((9, 2))
    on = np.concatenate([share.constant(20, 1), share.constant(20, 1, [1.0])], axis=2)
    outputs, _ = model.advance_under(start, 20, on)
    free, _ = model.advance(start, 20)
    assert np.array_equal(outputs[..., 0], free[..., 0])
    assert not np.allclose(outputs[..., 1], free[..., 1], atol=0.01)


# -- columns of a record that are known in advance -------------------------------------------------
SIMULATED = CASE
SPACE = MeasuredSeries(("x", "y", "z"), "z")
DATA = {
    **{"components": ["x", "y", "z"], "known": ["rho"], "time_step": 0.02},
    **{"blocks": None, "gaps": None},
}
# what is known of rho in a record: its column, and no value of the case's own
MEASURED = replace(SIMULATED, system=SPACE, parameters=Parameters(("rho",), ()))


@pytest.fixture(scope="module")
def simulated():
    """States ``(6, time, 3)`` under a parameter that changes now and then, and its schedule."""
    generator = np.random.default_rng(4)
    changes = generator.random((800, 6)) < 0.05
    schedule = np.array([24.0, 28.0, 33.0])[np.cumsum(changes, axis=0) % 3][:, np.newaxis]
    start = generator.normal(size=(3, 6)) + np.array([[1.0], [1.0], [25.0]])
    states = integrate_scheduled(RHO, schedule, start, 0.0025, 8)
    return tuple(np.ascontiguousarray(one.transpose(2, 0, 1)) for one in (states, schedule))


@pytest.fixture(scope="module")
def record(simulated, tmp_path_factory):
    """The same as files: a row has the value that was in force up to it."""
    directory = tmp_path_factory.mktemp("record")
    paths = []
    for number, (states, schedule) in enumerate(zip(*simulated, strict=True)):
        column = np.concatenate([[99.0], schedule[:, 0]])  # of the first row nothing is used
        paths.append(str(directory / f"{number}.csv"))
        rows = np.column_stack([0.02 * np.arange(len(states)), states, column])
        header = {"delimiter": ",", "header": "time,x,y,z,rho", "comments": ""}
        np.savetxt(paths[-1], rows, fmt="%.17g", **header)
    return recorded_series(paths, DATA, SPACE)


def trained(kind, case, states, schedules):
    if kind == "quadratic_aware":
        return LEARNT.fit_under(states, case, schedules)
    seed = ReservoirSeed(1, 60, 0, 4, 0.1)
    scale = np.ptp(states, axis=(0, 1))
    plain = TrainingSeries(states, scale)
    series, factors = factored_training(plain, schedules, case, NETWORK)
    told = {"factors": factors, "in_force": case.parameters}
    how = {"washout": 20, "tikhonov": 1e-9}
    dynamics = Dynamics(seed.reservoir(3), 0.3, 0.5, "scipy")
    return NETWORK.trained(dynamics, seed, series, **how, **told)


def test_a_record_of_a_simulated_flow_is_that_flow_with_its_schedule(simulated, record):
    states, schedules = simulated
    np.testing.assert_array_equal(record.states, states)
    np.testing.assert_array_equal(record.covariates[:, 1:], schedules)


@pytest.mark.parametrize("kind", ["quadratic_aware", "esn_aware"])
def test_forecasts_from_the_record_are_those_of_the_simulated_case(simulated, record, kind):
    states, schedules = simulated
    one = trained(kind, SIMULATED, states[:4], schedules[:4])
    other = trained(kind, MEASURED, record.states[:4], record.covariates[:4, 1:])
    for name, array in one.record().arrays.items():
        np.testing.assert_array_equal(other.record().arrays[name], array, err_msg=name)
    starts = [(row, step) for row in (4, 5) for step in range(40, 700, 60)]
    washouts = np.stack([states[row, step - 29 : step + 1] for row, step in starts])
    in_force = np.stack([schedules[row, step - 29 : step + 60] for row, step in starts])
    boundaries = (20, 40, 60)
    expected = window_forecasts(one, SPACE.observable, washouts, boundaries, in_force)
    # a batch, and one after the other
    found = window_forecasts(other, SPACE.observable, washouts, boundaries, in_force)
    each = [
        window_forecasts(other, SPACE.observable, washouts[[row]], boundaries, in_force[[row]])
        for row in range(len(starts))
    ]
    alone = np.concatenate([forecasts.largest for forecasts in each])
    np.testing.assert_array_equal(found.largest, expected.largest)
    np.testing.assert_allclose(alone, expected.largest, rtol=1e-9)
    # the forecast of another future is another one, and of none there is none
    wrong = in_force.copy()
    wrong[:, 29:] = 24.0
    elsewhere = window_forecasts(other, SPACE.observable, washouts, boundaries, wrong)
    assert not np.array_equal(elsewhere.largest, found.largest)
    with pytest.raises(ValueError, match="rho: values over the whole forecast must be given"):
        window_forecasts(other, SPACE.observable, washouts, boundaries)


class Driven(MadeUpForecaster):
    """Each step adds the value in force; nothing is learnt."""

    aware = True

    def start(self, washout):
        raise NotImplementedError

    def start_under(self, washout, schedule):
        assert schedule.shape == (len(washout) - 1, 1, washout.shape[2])
        # the washout's own values must be those of the same steps
        np.testing.assert_allclose(np.diff(washout, axis=0), schedule, atol=1e-12)
        return washout[-1]

    def advance(self, memory, steps):
        raise NotImplementedError

    def advance_under(self, memory, steps, schedule):
        assert schedule.shape == (steps, 1, memory.shape[1])
        outputs = memory + np.cumsum(schedule, axis=0)
        return outputs, outputs[-1]


def test_horizons_under_a_schedule_end_where_it_is_wrong():
    search = HorizonSearch(4.0, 1.0, 0.5, washout=5, steps_per_lyapunov_time=10)
    generator = np.random.default_rng(3)
    schedules = generator.normal(size=(700, search.steps_before_event, 1))
    truth = np.concatenate([np.zeros((700, 1)), np.cumsum(schedules[..., 0], axis=1)], axis=1)
    observed = truth[..., np.newaxis].copy()

    def found(in_force):
        return prediction_horizons(
            Driven(), lambda states: states[0], observed, truth, search, in_force
        )

    np.testing.assert_array_equal(found(schedules), 4.0)
    wrong = schedules.copy()
    wrong[:, -15] += 1.0  # 15 steps before the event: only later starts do not pass it
    np.testing.assert_array_equal(found(wrong), 1.0)


def test_classifiers_learn_from_what_is_known():
    generator = np.random.default_rng(5)
    washouts, known = generator.normal(size=(1500, 3, 2)), generator.normal(size=(1500, 2))
    happened = (known[:, 1] + washouts[:, -1, 0] > 1.5)[:, np.newaxis]
    series = np.arange(1500) // 150
    case = replace(SIMULATED, random_seed=1)
    for kind, options in (
        ("precursor", {"lags_lt": [], "classifier": "logistic"}),
        ("esn_direct", {"penalty": [1], "neurons": 40, "connectivity": 3}),
    ):
        classifier, scores = make_classifier(kind, options), []
        for features in (None, known):
            points = LabelledPoints(washouts, happened, series, features).of(
                series < 7, np.array([True])
            )
            fitted = classifier.fit(points, case)
            later = None if features is None else features[series >= 7]
            chance = fitted.probabilities(washouts[series >= 7], later)[:, 0]
            assert ((chance > 0) & (chance < 1)).all()
            scores.append(np.mean((chance - happened[series >= 7, 0]) ** 2))
            again = classifier.restore(fitted.record(), case)
            same = again.probabilities(washouts[series >= 7], later)[:, 0]
            np.testing.assert_array_equal(same, chance)
        assert scores[1] < 0.5 * scores[0], kind
