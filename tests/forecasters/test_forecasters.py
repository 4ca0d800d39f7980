"""Every kind that forecasts trajectories keeps to the same rules; those that learn least alone."""

import numpy as np
import pytest
from sklearn.linear_model import LinearRegression, Ridge
from sklearn.preprocessing import PolynomialFeatures

from burstcast.forecasters._limits import TrainingLimits
from burstcast.forecasters.analogues import Analogues
from burstcast.forecasters.base import ForecasterRecord, ForecastingCase
from burstcast.forecasters.equations import EquationsFromTruth
from burstcast.forecasters.equations_filtered import FilteredEquations
from burstcast.forecasters.equations_noisy import EquationsFromObservation
from burstcast.forecasters.esn import NetworkForecaster, ReservoirSeed
from burstcast.forecasters.esn_true_washout import NetworkFromTruth
from burstcast.forecasters.linear_inverse import LinearInverseModel
from burstcast.forecasters.nvar import NVAR
from burstcast.forecasters.persistence import Persistence
from burstcast.forecasters.quadratic import QuadraticModel
from burstcast.forecasters.quadratic_filtered import FilteredQuadraticModel
from burstcast.forecasters.registry import (
    all_kinds,
    available_kinds,
    kind_class,
    make_kind,
    make_kind_of,
    trajectory_kinds,
)
from burstcast.forecasts.windows import member_forecasts
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.network import EchoStateNetwork
from burstcast.networks.readout import Readout
from burstcast.networks.training import TrainingSeries, train
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.polynomials.system import PolynomialSystem
from helpers_library import (
    assert_depends_on_its_washout_alone,
    assert_perturbations_grow_as_differences,
)

SYSTEM = MoehlisFaisstEckhardt(reynolds=400.0)


@pytest.fixture(scope="module")
def flow():
    """Chaotic trajectories of the shear flow at the networks' interval, (steps, 9, batch)."""
    start = np.array([1, 0, 0.07066, -0.07076, 0, 0, 0, 0, 0])[:, np.newaxis]
    perturbed = start + 0.01 * np.random.default_rng(2).random((9, 5))
    return integrate(SYSTEM, perturbed, 0.25, 4 * 260, stride=4)[200:]


SEED = ReservoirSeed(random_seed=2022, neurons=30, seed=5, connectivity=6, input_bias=0.1)


NOISE = np.linspace(0.001, 0.002, 9)
COEFFICIENTS = 0.05 * np.random.default_rng(7).standard_normal((55, 9))
SERIES = np.random.default_rng(8).standard_normal((3, 40, 9))
STEPS = {"time_step": 0.25, "sampling_stride": 4}
QUADRATIC = QuadraticModel(
    system=PolynomialSystem(COEFFICIENTS, 2, SYSTEM), coefficients=COEFFICIENTS, **STEPS
)
OBSERVED = EquationsFromObservation(system=SYSTEM, **STEPS)
READOUT = Readout(0.1 * np.random.default_rng(5).normal(size=(31, 9)), 1e-6, "cholesky", 1e-9)
DYNAMICS = Dynamics(SEED.reservoir(9), 0.9, 1.0, "scipy")
NETWORK = {"network": EchoStateNetwork(DYNAMICS, READOUT, np.linspace(0.2, 1, 9)), "seed": SEED}
CASE = ForecastingCase(system=SYSTEM, time_step=0.25, sampling_stride=4, steps_per_lyapunov_time=61)

FORECASTERS = {
    "analogues": Analogues(neighbours=5, training=SERIES),
    "equations": EquationsFromTruth(system=SYSTEM, **STEPS),
    "equations_noisy": OBSERVED,
    "equations_filtered": FilteredEquations(
        members=18, inflation=1.01, model=OBSERVED, errors=NOISE
    ),
    "esn": NetworkForecaster(backend="scipy", **NETWORK),
    "esn_true_washout": NetworkFromTruth(backend="scipy", **NETWORK),
    "linear_inverse": LinearInverseModel(
        propagator=0.3 * np.random.default_rng(6).standard_normal((9, 9)),
        constant=np.linspace(-1, 1, 9),
    ),
    "nvar": NVAR(lags=3, ridge=1e-3).fit(SERIES, CASE),
    "persistence": Persistence(),
    "quadratic": QUADRATIC,
    "quadratic_filtered": FilteredQuadraticModel(
        members=18, inflation=1.01, model=QUADRATIC, errors=NOISE
    ),
}


@pytest.mark.parametrize("name", FORECASTERS)
def test_forecasts_depend_on_nothing_but_their_washout(name, flow):
    assert_depends_on_its_washout_alone(FORECASTERS[name], flow[:20], 12, CASE)


@pytest.mark.parametrize("name", [kind for kind in FORECASTERS if kind_class(kind).linearises()])
def test_perturbations_grow_as_differences_do(name, flow):
    forecaster = FORECASTERS[name]
    assert_perturbations_grow_as_differences(forecaster, forecaster.start(flow[:20]))


@pytest.mark.parametrize("name", FORECASTERS)
def test_members_of_an_ensemble_forecast_as_if_each_were_alone(name, flow):
    forecaster = FORECASTERS[name]
    ensemble, memory = forecaster.ensemble(flow[:20]), forecaster.start(flow[:20])
    assert ensemble.shape[-1] == 5
    np.testing.assert_array_equal(forecaster.combined(ensemble), memory)
    # several members where the kind says so; elsewhere the only one is the single forecast
    assert forecaster.provides_ensemble == (ensemble.shape[-2] > 1)
    if not forecaster.provides_ensemble:
        np.testing.assert_array_equal(ensemble[..., 0, :], memory)
    states = member_forecasts(forecaster, flow[:20], 6)
    assert states.shape == (6, 9, *ensemble.shape[-2:])
    for member in range(ensemble.shape[-2]):
        alone, _ = forecaster.advance(np.ascontiguousarray(ensemble[..., member, :]), 6)
        np.testing.assert_array_equal(states[:, :, member], alone)


@pytest.mark.parametrize("kind", [EquationsFromTruth, EquationsFromObservation])
def test_the_equations_learn_nothing_and_continue_the_last_observation(kind, flow):
    training, forecaster = flow.transpose(2, 0, 1), kind(system=SYSTEM, **STEPS)
    assert kind().fit(training, CASE) == kind().fit(0 * training, CASE) == forecaster
    assert forecaster.record() == ForecasterRecord()
    assert list(forecaster.leave_one_out(training, CASE, 20)) == [forecaster] * 5
    noisy = flow[:20] + 0.01
    noisy[-1] = flow[19]
    outputs, _ = forecaster.advance(forecaster.start(noisy), 30)
    np.testing.assert_array_equal(outputs, flow[20:50])
    assert not forecaster.diverged(outputs).any()


# -- kinds, and what forecasters are restored from -------------------------------------------------
INTEGRATING = {"equations", "equations_filtered", "equations_noisy"}
FILTERING = {"equations_filtered", "quadratic_filtered", "quadratic_aware_filtered"}
AWARE = {"esn_aware", "quadratic_aware", "quadratic_aware_filtered"}


@pytest.mark.parametrize(
    ("what", "expected"),
    [
        ("has_trajectories", {*FORECASTERS, *AWARE}),
        ("sees_truth", {"equations", "esn_true_washout"}),  # only the bounds
        ("needs_equations", INTEGRATING),
        ("provides_ensemble", {"analogues", *FILTERING}),
        ("has_filter", FILTERING),
        ("aware", {*INTEGRATING, *AWARE}),
        ("learns_parameters", AWARE),
        ("has_search", {"esn", "esn_aware", "esn_true_washout"}),
        ("searched_as", {"esn_true_washout"}),
    ],
)
def test_kinds_say_what_they_are(what, expected):
    kinds = {kind: kind_class(kind) for kind in all_kinds()}
    assert {
        kind for kind, kind_class in kinds.items() if getattr(kind_class, what, False)
    } == expected
    assert NetworkFromTruth.searched_as == "esn"
    assert not AWARE & {*available_kinds()}  # they need schedules


def test_every_kind_is_tested_here():
    assert sorted(FORECASTERS) == trajectory_kinds()
    for kind, forecaster in FORECASTERS.items():
        assert kind_class(kind) is type(forecaster)
        # an unfitted forecaster is made of all its options, which fields that are fitted are not
        made = make_kind(kind, forecaster.options)
        assert made == type(forecaster)(**forecaster.options)
        for name in vars(forecaster).keys() - forecaster.options.keys():
            with pytest.raises(ValueError, match=f"forecaster '{kind}' has no option '{name}'"):
                make_kind_of(type(forecaster), {name: 1})


def test_a_network_that_has_not_seen_a_series_is_trained_on_the_others(flow):
    training, network = flow.transpose(2, 0, 1), FORECASTERS["esn"].network
    refitted = list(FORECASTERS["esn"].leave_one_out(training, CASE, 20))
    assert len(refitted) == len(training)
    for row, left_out in enumerate(refitted):
        others = TrainingSeries(np.delete(training, row, axis=0), network.input_range)
        readout = train(network.dynamics, others, washout=20, tikhonov=network.readout.tikhonov)
        np.testing.assert_allclose(left_out.network.readout.weights, readout.weights, rtol=1e-5)
        assert left_out.network.dynamics is network.dynamics
        assert (left_out.seed, left_out.divergence_bound) == (SEED, 10.0)


def test_the_bound_of_a_restored_network_is_an_option_and_it_is_not_fitted_without_a_search(flow):
    record = FORECASTERS["esn"].record()
    outputs = 3.0 * np.ones((1, 9, 1))
    limits = TrainingLimits(-0.5 * np.ones(9), 0.5 * np.ones(9))
    for bound, lost in ((1.0, True), (100.0, False), (None, False)):
        restored = NetworkForecaster(backend="scipy", divergence_bound=bound).restore(record, CASE)
        assert restored.within(limits).diverged(outputs).tolist() == [lost]
    with pytest.raises(NotImplementedError, match="search"):
        NetworkForecaster().fit(flow.transpose(2, 0, 1), CASE)


# -- analogues and persistence ---------------------------------------------------------------------

LORENZ = ForecastingCase(Lorenz63(), 0.01, 2, 50)
WALKS = np.random.default_rng(1).standard_normal((3, 30, 2)).cumsum(axis=1) * [1.0, 20.0]
LAST_STATES = np.random.default_rng(2).standard_normal((5, 2, 7)) * [[3.0], [60.0]]
LONG_WALKS = np.random.default_rng(1).standard_normal((4, 200, 3)).cumsum(axis=1)


def continuations(state, neighbours, steps):
    """What followed the nearest states, brute force; NaN after the end of a series."""
    distance = np.square((WALKS[:, :-1] - state) / WALKS.std(axis=(0, 1))).sum(axis=2)
    nearest = np.argsort(distance, axis=None)[:neighbours]
    padded = np.concatenate([WALKS, np.full((len(WALKS), steps, 2), np.nan)], axis=1)
    places = [np.unravel_index(index, distance.shape) for index in nearest]
    return np.array([padded[row, step + 1 : step + 1 + steps] for row, step in places])


def test_members_follow_one_analogue_each_and_the_forecast_is_their_mean():
    model = Analogues(neighbours=4).fit(WALKS, LORENZ)
    outputs, _ = model.advance(model.start(LAST_STATES), 12)
    members = model.ensemble(LAST_STATES)
    assert members.shape == (1, 4, 7)
    of_members = model.advance(members.reshape(1, -1), 12)[0].reshape(12, 2, 4, 7)
    for point in range(7):
        followed = continuations(LAST_STATES[-1, :, point], 4, 12)
        np.testing.assert_array_equal(of_members[..., point].transpose(2, 0, 1), followed)
        alive = np.isfinite(followed[..., 0]).any(axis=0)
        expected = np.nanmean(followed[:, alive], axis=0)
        np.testing.assert_allclose(outputs[alive, :, point], expected)
        assert np.isnan(outputs[~alive, :, point]).all()


def test_where_analogues_have_ended_there_is_no_forecast_and_constants_tell_none_apart():
    model = Analogues(neighbours=4).fit(WALKS, LORENZ)
    outputs, memory = model.advance(model.start(LAST_STATES), 30)
    assert model.diverged(outputs).all()
    for ended in (outputs[-1], memory, model.advance(memory, 1)[0]):
        assert np.isnan(ended).all()
    with_gauge = np.insert(WALKS, 2, 7.0, axis=2)
    memory = (
        Analogues(neighbours=4).fit(with_gauge, LORENZ).start(np.insert(LAST_STATES, 2, 7.0, 1))
    )
    np.testing.assert_array_equal(memory, model.start(LAST_STATES))


def test_persistence_stays():
    model = Persistence().fit(np.zeros((1, 1, 2)), LORENZ)
    outputs, memory = model.advance(model.start(LAST_STATES), 3)
    for state in outputs:
        np.testing.assert_array_equal(state, LAST_STATES[-1])
    np.testing.assert_array_equal(memory, LAST_STATES[-1])


# -- the linear inverse model ----------------------------------------------------------------------


def test_a_linear_system_is_found_and_is_the_regression_of_scikit_learn():
    generator = np.random.default_rng(2)
    matrix, constant = 0.4 * generator.standard_normal((3, 3)), np.array([1.0, -2.0, 0.5])
    states = [generator.standard_normal((3, 5))]
    for _ in range(30):
        states.append(matrix @ states[-1] + constant[:, np.newaxis])
    true = np.array(states)  # (time, dimension, series)
    model = LinearInverseModel().fit(true[:20].transpose(2, 0, 1), LORENZ)
    outputs, memory = model.advance(model.start(true[:20]), 11)
    np.testing.assert_allclose(outputs, true[20:], atol=1e-9)
    np.testing.assert_array_equal(memory, outputs[-1])
    model = LinearInverseModel().fit(LONG_WALKS, LORENZ)
    now, following = (part.reshape(-1, 3) for part in (LONG_WALKS[:, :-1], LONG_WALKS[:, 1:]))
    expected = LinearRegression().fit(now, following)
    np.testing.assert_allclose(model.propagator, expected.coef_, atol=1e-10)
    np.testing.assert_allclose(model.constant, expected.intercept_, atol=1e-10)


# -- nonlinear vector autoregression ---------------------------------------------------------------


def test_nonlinear_autoregression_is_the_ridge_regression_of_scikit_learn():
    model = NVAR(lags=3, ridge=0.02).fit(LONG_WALKS, LORENZ)
    mean, scale = LONG_WALKS.mean(axis=(0, 1)), LONG_WALKS.std(axis=(0, 1))
    states = (LONG_WALKS - mean) / scale
    # polynomials of scikit-learn of each state and those before it, latest first
    past = np.concatenate([states[:, 2 - lag : 200 - lag] for lag in range(3)], axis=2)[:, :-1]
    features = PolynomialFeatures(2).fit_transform(past.reshape(-1, 9))
    increments = np.diff(states[:, 2:], axis=1).reshape(-1, 3)
    # penalties are for the mean over samples here, and for their sum there
    ridge = Ridge(0.02 * len(features), fit_intercept=False).fit(features, increments)
    np.testing.assert_allclose(model.weights, ridge.coef_.T, rtol=1e-8)
    # one step, by hand
    latest = ((LONG_WALKS[0, 50:53] - mean) / scale)[::-1].ravel()
    products = [a * b for place, a in enumerate(latest) for b in latest[place:]]
    following = latest[:3] + ridge.coef_ @ np.array([1.0, *latest, *products])
    washout = LONG_WALKS[:1, 40:53].transpose(1, 2, 0)
    outputs, memory = model.advance(model.start(washout), 1)
    np.testing.assert_allclose(outputs[0, :, 0], following * scale + mean, rtol=1e-10)
    np.testing.assert_allclose(memory[:, 0], [*following, *latest[:6]], rtol=1e-10)


def test_nonlinear_autoregression_says_what_it_cannot_do():
    for options, message in (
        ({"lags": 0}, "lags must be 1 at least, not 0"),
        ({"ridge": 0.0}, r"ridge must be above 0, not 0\.0"),
        ({"ridge": np.nan}, "ridge must be above 0, not nan"),
    ):
        with pytest.raises(ValueError, match=message):
            NVAR(**options)
    model = NVAR(lags=4)
    with pytest.raises(ValueError, match="4 lags take series of more than 4 samples"):
        model.fit(LONG_WALKS[:, :4], LORENZ)
    fitted = model.fit(LONG_WALKS[:, :5], LORENZ)
    with pytest.raises(ValueError, match="4 lags take a washout of 4 steps at least"):
        fitted.start(LONG_WALKS[:, :3].transpose(1, 2, 0))
    assert fitted.start(LONG_WALKS[:, :4].transpose(1, 2, 0)).shape == (12, 4)


def test_a_forecast_is_invalid_from_its_first_step_beyond_ten_training_ranges_on():
    """Whatever the kind; the middle of each component's range is where distances count from."""
    training = np.zeros((2, 5, 3))
    training[0, 0], training[1, 4] = [100.0, -1.0, 7.0], [104.0, 1.0, 7.0]
    training[1, 4, 0], training[1, 4, 2] = 104.0, 7.0
    training[..., 0] = np.clip(training[..., 0], 100.0, None)
    training[..., 2] = 7.0  # constant: no range, no bound
    limits = TrainingLimits.of(training, 3)
    assert (limits.low.tolist(), limits.high.tolist()) == ([100.0, -1.0, 7.0], [104.0, 1.0, 7.0])
    model = NVAR().within(limits)
    outputs = np.tile(np.array([102.0, 0.0, 7.0])[:, np.newaxis], (6, 1, 6))
    outputs[:, 0, 0] = 142.0  # at the bound
    outputs[2, 0, 1] = 142.1
    outputs[3, 1, 2] = -20.1
    outputs[1, 2, 3] = 1e9
    outputs[4, 2, 4] = np.nan
    outputs[5, 1, 5] = np.inf
    first = [np.flatnonzero(column)[:1].tolist() for column in model.invalid(outputs).T]
    assert first == [[], [2], [3], [], [4], [5]]
    assert model.diverged(outputs).tolist() == [False, True, True, False, True, True]
    valid = model.valid(outputs)
    np.testing.assert_array_equal(np.isnan(valid).all(axis=1), model.invalid(outputs))
    np.testing.assert_array_equal(valid[:2, :, 1], outputs[:2, :, 1])
    sound = outputs[..., :1]
    assert model.valid(sound) is sound
    # without ranges it is judged by being finite alone
    assert NVAR().diverged(outputs).tolist() == [False, False, False, False, True, True]
    assert not model.diverged(outputs[:0]).any()
    assert "limits" not in model.options
