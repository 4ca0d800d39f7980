"""Every kind that forecasts trajectories keeps to the same rules; those that learn least alone."""

import re
from dataclasses import replace

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
from burstcast.forecasters.esn_filtered import FilteredNetwork
from burstcast.forecasters.esn_true_washout import NetworkFromTruth
from burstcast.forecasters.linear_inverse import LinearInverseModel
from burstcast.forecasters.nvar import NVAR
from burstcast.forecasters.persistence import Persistence
from burstcast.forecasters.quadratic import QuadraticModel
from burstcast.forecasters.quadratic_filtered import FilteredQuadraticModel
from burstcast.forecasters.quadratic_hidden import HiddenQuadraticModel
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
from burstcast.systems.polynomials.hidden import hidden_series, moving_averages
from burstcast.systems.polynomials.system import PolynomialSystem
from helpers_library import (
    FirstObserved,
    assert_depends_on_its_washout_alone,
    assert_perturbations_grow_as_differences,
    lorenz_series,
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
COEFFICIENTS_OF_TEN = 0.05 * np.random.default_rng(9).standard_normal((66, 10))
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

HIDDEN = HiddenQuadraticModel(
    hidden=1,
    members=8,
    system=PolynomialSystem(0.3 * COEFFICIENTS_OF_TEN, 2, SYSTEM),
    coefficients=0.3 * COEFFICIENTS_OF_TEN,
    prior=0.1 * np.ones((10, 1)),
    prior_root=0.1 * np.eye(1),
    errors=NOISE,
    model_error=0.3 * NOISE,
    hidden_scale=np.ones(1),
    reach=10.0 * np.ones(10),
    place=-1,
    random_seed=3,
    rates=np.array([0.5, 1.0]),
    explained=0.5,
    round_errors=np.array([-1.0, -2.0]),
    consistency=np.ones(9),
    **STEPS,
)

FORECASTERS = {
    "analogues": Analogues(neighbours=5, training=SERIES),
    "equations": EquationsFromTruth(system=SYSTEM, **STEPS),
    "equations_noisy": OBSERVED,
    "equations_filtered": FilteredEquations(
        members=18, inflation=1.01, model=OBSERVED, errors=NOISE
    ),
    "esn": NetworkForecaster(backend="scipy", **NETWORK),
    "esn_filtered": FilteredNetwork(
        backend="scipy",
        members=8,
        voters=4,
        errors=NOISE,
        model_error=0.2 * NOISE,
        consistency=np.ones(9),
        start_up=4,
        lag=3,
        smoothing_weights=0.9 * READOUT.weights,
        noise_left=np.ones((1, 9)),
        noise_removed=np.ones((1, 9)),
        round_errors=np.array([-1.0, -2.0]),
        **NETWORK,
    ),
    "esn_true_washout": NetworkFromTruth(backend="scipy", **NETWORK),
    "linear_inverse": LinearInverseModel(
        propagator=0.3 * np.random.default_rng(6).standard_normal((9, 9)),
        constant=np.linspace(-1, 1, 9),
    ),
    "nvar": NVAR(lags=3, ridge=1e-3).fit(SERIES, CASE),
    "persistence": Persistence(),
    "quadratic": QUADRATIC,
    "quadratic_hidden": HIDDEN,
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
        ("provides_ensemble", {"analogues", "esn_filtered", "quadratic_hidden", *FILTERING}),
        ("has_filter", {"esn_filtered", "quadratic_hidden", *FILTERING}),
        ("aware", {*INTEGRATING, *AWARE}),
        ("learns_parameters", AWARE),
        ("has_search", {"esn", "esn_aware", "esn_filtered", "esn_true_washout"}),
        ("searched_as", {"esn_filtered", "esn_true_washout"}),
    ],
)
def test_kinds_say_what_they_are(what, expected):
    kinds = {kind: kind_class(kind) for kind in all_kinds()}
    assert {
        kind for kind, kind_class in kinds.items() if getattr(kind_class, what, False)
    } == expected
    assert NetworkFromTruth.searched_as == FilteredNetwork.searched_as == "esn"
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


# -- networks with a filter ------------------------------------------------------------------------

OF_LORENZ = {"washout": 25, "tikhonov": 1e-9, "steps_per_lyapunov_time": 55}
LORENZ_SEED = ReservoirSeed(random_seed=1, neurons=100, seed=0, connectivity=20, input_bias=1.0)
LORENZ_DYNAMICS = Dynamics(LORENZ_SEED.reservoir(3), 0.3, 0.4, readout="quadratic")
TRUE_LORENZ = lorenz_series(4, 200, 700)
LORENZ_SCALE = TRUE_LORENZ.std(axis=(0, 1))
LORENZ_NOISE = 0.04 * LORENZ_SCALE
NOISY_LORENZ = TRUE_LORENZ + LORENZ_NOISE * np.random.default_rng(3).normal(size=TRUE_LORENZ.shape)


def trained_on_lorenz(kind, series=NOISY_LORENZ[:3]):
    training = TrainingSeries(series, np.ptp(series, axis=(0, 1)), series.mean(axis=(0, 1)))
    return kind.trained(LORENZ_DYNAMICS, LORENZ_SEED, training, **OF_LORENZ)


@pytest.fixture(scope="module")
def filtered_network():
    return trained_on_lorenz(FilteredNetwork())


def washouts_of(series, length=25, spacing=10):
    """Washouts ``(steps, dimension, points)`` and the state after each."""
    ends = range(length, series.shape[1], spacing)
    cut = [series[:, end - length : end].transpose(1, 2, 0) for end in ends]
    return np.concatenate(cut, axis=2), series[:, ends].transpose(2, 1, 0).reshape(
        series.shape[2], -1
    )


def test_rounds_of_denoising_remove_noise_and_the_filter_finds_the_present(filtered_network):
    model = filtered_network
    assert model.weaknesses() == []
    assert model.kept_round > 0
    assert (model.noise_left.mean(axis=1) < 0.4).all()
    np.testing.assert_allclose(model.consistency, 1, atol=0.2)
    np.testing.assert_allclose(model.errors, LORENZ_NOISE, rtol=0.1)
    # against the truth, which nothing has seen
    smoother = trained_on_lorenz(FilteredNetwork(denoising_rounds=0))
    smoothed = smoother._follow(NOISY_LORENZ[:3], model.lag).smoothed
    off = np.sqrt(np.square((smoothed - TRUE_LORENZ[:3]) / LORENZ_NOISE).mean(axis=(0, 2)))
    assert np.sqrt(np.square(off[20:-20]).mean()) < 0.5
    observed = np.square((NOISY_LORENZ - TRUE_LORENZ)[:3] / LORENZ_NOISE).mean(axis=(0, 2))
    for ends in (slice(20), slice(-5, None)):
        assert np.square(off[ends]).mean() < observed[ends].mean()
    # sample by sample, neither before nor after its time
    for shift in (-1, 1):
        moved = smoothed[:, 20 + shift : -20 + shift] - TRUE_LORENZ[:3, 20:-20]
        assert np.square(moved / LORENZ_NOISE).mean() > 4 * np.square(off[20:-20]).mean()
    # the member of an ensemble that has seen the washout predicts the next state
    washout, truth = washouts_of(NOISY_LORENZ[3:])[0], washouts_of(TRUE_LORENZ[3:])[1]
    misses = {}
    for name, start in (("filtered", model.start), ("driven", model.network.washout)):
        ahead = model.advance(start(washout), 1)[0][0]
        misses[name] = np.sqrt(np.square((ahead - truth) / LORENZ_NOISE[:, np.newaxis]).mean())
    assert misses["filtered"] < 0.6 < misses["driven"]


def test_a_filter_is_synchronised_before_it_begins(filtered_network):
    """Soon after a start-up from a reservoir at zero, the present would be unknown."""
    model = filtered_network
    short = model.start_up + 3
    washout, truth = washouts_of(NOISY_LORENZ[3:], short)[0], washouts_of(TRUE_LORENZ[3:], short)[1]
    ahead = model.advance(model.start(washout), 1)[0][0]
    off = (ahead - truth) / LORENZ_NOISE[:, np.newaxis]
    assert np.sqrt(np.square(off).mean()) < 1.0
    with pytest.raises(ValueError, match=f"washout of {short - 1} samples is too short .* {short}"):
        model.start(washout[1:])
    with pytest.raises(ValueError, match="washout of 10 samples is too short"):
        FilteredNetwork().trained(
            LORENZ_DYNAMICS,
            LORENZ_SEED,
            TrainingSeries(NOISY_LORENZ, np.ones(3)),
            **{**OF_LORENZ, "washout": 10},
        )


def test_without_rounds_it_is_the_network_of_esn_and_without_noise_its_forecast():
    options = {"washout": 25, "tikhonov": 1e-9}
    plain = trained_on_lorenz(NetworkForecaster())
    model = trained_on_lorenz(FilteredNetwork(denoising_rounds=0, noise=0.0))
    weights = plain.network.readout.weights
    np.testing.assert_array_equal(model.network.readout.weights, weights)
    washout, _ = washouts_of(NOISY_LORENZ[3:])
    expected = plain.advance(plain.start(washout), 20)[0]
    np.testing.assert_allclose(model.advance(model.start(washout), 20)[0], expected, atol=1e-6)
    assert options["tikhonov"] == model.network.readout.tikhonov
    assert model.smoothing_weights is None


def test_forecasts_do_not_depend_on_zero_and_unit_of_the_components(filtered_network):
    unit, zero = np.array([1000.0, 1.0, 0.01]), np.array([5.0, -300.0, 0.2])
    other = trained_on_lorenz(FilteredNetwork(), NOISY_LORENZ[:3] * unit + zero)
    np.testing.assert_allclose(other.model_error, filtered_network.model_error * unit, rtol=1e-3)
    washout, _ = washouts_of(NOISY_LORENZ[3:])
    expected = filtered_network.advance(filtered_network.start(washout), 10)[0]
    there = washout * unit[:, np.newaxis] + zero[:, np.newaxis]
    outputs = (other.advance(other.start(there), 10)[0] - zero[:, np.newaxis]) / unit[:, np.newaxis]
    np.testing.assert_allclose(
        outputs / LORENZ_SCALE[:, None], expected / LORENZ_SCALE[:, None], atol=1e-3
    )


def test_a_filtered_network_is_saved_and_its_points_are_independent(filtered_network):
    washout = np.tile(washouts_of(NOISY_LORENZ[3:])[0], (1, 1, 2))[..., :50]
    case = ForecastingCase(Lorenz63(), 0.01, 2, 55)
    assert_depends_on_its_washout_alone(filtered_network, washout, 12, case)
    restored = FilteredNetwork().restore(filtered_network.record(), case)
    assert restored.weaknesses() == filtered_network.weaknesses()
    np.testing.assert_array_equal(restored.ensemble(washout), filtered_network.ensemble(washout))
    # readouts of all series but one, of the series that the network before has smoothed
    refitted = list(restored.leave_one_out(NOISY_LORENZ[:3], case, 25))
    network = filtered_network.network
    weights = filtered_network.smoothing_weights
    smoother = replace(
        filtered_network,
        network=replace(network, readout=replace(network.readout, weights=weights)),
    )
    training = TrainingSeries(NOISY_LORENZ[:3], network.input_range, network.input_offset)
    learnt = smoother._denoised(training, smoother._follow(NOISY_LORENZ[:3], smoother.lag))
    whole = train(network.dynamics, learnt, washout=25, tikhonov=1e-9)
    np.testing.assert_array_equal(whole.weights, network.readout.weights)
    for row, left_out in enumerate(refitted):
        others = learnt.part(np.delete(np.arange(3), row))
        readout = train(network.dynamics, others, washout=25, tikhonov=1e-9)
        outputs = [
            replace(network, readout=found).forecast(network.washout(washout), 5)[0]
            for found in (readout, left_out.network.readout)
        ]
        np.testing.assert_allclose(*outputs, rtol=1e-4, atol=1e-4)


def test_series_of_unequal_lengths_are_smoothed_in_any_order():
    lengths = [500, 420, 460]
    series = NOISY_LORENZ[:3].copy()
    for row, length in enumerate(lengths):
        series[row, length:] = np.nan
    scales = np.ptp(NOISY_LORENZ, axis=(0, 1)), NOISY_LORENZ.mean(axis=(0, 1))
    training = TrainingSeries(series, *scales).longest_first()
    model = FilteredNetwork(denoising_rounds=1).trained(
        LORENZ_DYNAMICS, LORENZ_SEED, training, **OF_LORENZ
    )
    assert np.isfinite(model.network.readout.weights).all()
    case = ForecastingCase(Lorenz63(), 0.01, 2, 55)
    orders = [[0, 1, 2], [2, 0, 1]]
    weights = [
        {
            row: left_out.network.readout.weights
            for row, left_out in zip(
                order, model.leave_one_out(series[order], case, 25), strict=True
            )
        }
        for order in orders
    ]
    washout, _ = washouts_of(NOISY_LORENZ[3:])
    states = model.start(washout)
    for row in range(3):
        outputs = [
            replace(
                model.network, readout=replace(model.network.readout, weights=some[row])
            ).forecast(states, 3)[0]
            for some in weights
        ]
        np.testing.assert_allclose(*outputs, rtol=1e-5, atol=1e-5)


def test_a_round_that_makes_forecasts_worse_is_not_kept_and_says_so():
    model = trained_on_lorenz(FilteredNetwork(denoising_rounds=1, jitter=300.0))
    assert model.kept_round == 0
    plain = trained_on_lorenz(NetworkForecaster())
    np.testing.assert_array_equal(model.network.readout.weights, plain.network.readout.weights)
    assert any("no round of denoising improved" in text for text in model.weaknesses())
    misjudging = replace(
        model,
        consistency=np.array([0.5, 1.0, 2.0]),
        noise_removed=np.full((1, 3), 1.5),
        model_error=3 * model.errors,
    )
    found = " ".join(misjudging.weaknesses())
    for text in ("0.5 to 2 times the expected", "removes 1.5 to 1.5 times", "is 3 times the noise"):
        assert text in found


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"denoising_rounds": -1}, "denoising_rounds must be 0 at least, not -1"),
        ({"members": 7}, "members must be even, and 4 at least, not 7"),
        ({"members": 8}, "voters must be even, and from 2 to members, 8, not 10"),
        ({"jitter": -0.1}, "jitter must not be negative"),
    ],
)
def test_options_of_a_filtered_network_are_checked(options, message):
    with pytest.raises(ValueError, match=message):
        FilteredNetwork(**options)


# -- equations with hidden variables ---------------------------------------------------------------


class OfTwo(FirstObserved):
    """Two components of Lorenz's flow, and its observable where that is a third one."""

    dimension = 2


HIDDEN_CASE = ForecastingCase(OfTwo(), 0.01, 2, 55)
HIDDEN_OPTIONS = {
    "hidden": 1,
    "rates_per_lt": (0.8, 1.65, 2.93, 5.5),
    "rounds": 1,
    "members": 20,
}
LONG_LORENZ = lorenz_series(5, 200, 1100)
NOISY_LONG = LONG_LORENZ + 0.01 * LORENZ_SCALE * np.random.default_rng(6).normal(
    size=LONG_LORENZ.shape
)


@pytest.fixture(scope="module")
def hidden_model():
    return HiddenQuadraticModel(**HIDDEN_OPTIONS).fit(NOISY_LONG[:4, :, :2], HIDDEN_CASE)


def share_explained(target, known):
    """R^2 of a linear regression with a constant; ``known``: ``(samples, ...)``."""
    return LinearRegression().fit(known, target).score(known, target)


@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_a_hidden_component_of_lorenz_is_a_moving_average_that_is_found(noise):
    """dz/dt = x y - 8/3 z: the average of x y with the rate 8/3, which is among those offered."""
    series = LONG_LORENZ + noise * LORENZ_SCALE * np.random.default_rng(3).normal(
        size=LONG_LORENZ.shape
    )
    rates = [0.015, 0.03, 8 / 3 * 0.02, 0.1]
    found = hidden_series(list(series[:, :, :2]), noise * LORENZ_SCALE[:2], 1, rates, 4)
    assert rates[2] in found.rates
    assert found.explained < 0.02
    hidden = np.concatenate(found.series)
    np.testing.assert_allclose(hidden.std(), 1.0, rtol=1e-3)
    seen = LONG_LORENZ[:, found.first :].reshape(-1, 3)
    known = np.column_stack([seen[:, :2], hidden])
    assert share_explained(seen[:, 2], known) > 0.99
    assert share_explained(seen[:, 2], seen[:, :2]) < 0.5


def test_a_moving_average_forgets_exponentially():
    impulse = np.zeros((1, 30))
    impulse[0, 4] = 1.0
    averages = moving_averages(impulse, 0.2)[0]
    assert (averages[:4] == 0.0).all()
    np.testing.assert_allclose(averages[6:] / averages[5:-1], np.exp(-0.2))
    np.testing.assert_allclose(averages.sum(), 1.0, atol=1e-2)
    np.testing.assert_array_equal(moving_averages(np.full((2, 9), 3.0), 0.7), 3.0)


def test_hidden_variables_that_cannot_be_found_are_refused():
    series = [np.random.default_rng(0).normal(size=(100, 2)) for _ in range(2)]
    for arguments, message in (
        ((series, np.zeros(2), 3, [0.1], 4), "hidden is 3; it must be from 1 to the 2 components"),
        ((series, np.zeros(2), 1, [0.01], 4), "raise the lowest rate"),
        (([np.zeros((9, 13))], np.zeros(13), 1, [0.1], 4), "behind 12 components at most, not 13"),
    ):
        with pytest.raises(ValueError, match=message):
            hidden_series(*arguments)
    for options, message in (
        ({"hidden": -1}, "hidden must be 0 at least"),
        ({"conserved": True}, "conserved takes an observable that follows"),
        ({"rounds": -1}, "rounds must be 0 at least"),
        ({"members": 5}, "members must be even"),
        ({"rates_per_lt": (0.0, 1.0)}, "rates_per_lt must be above 0"),
    ):
        with pytest.raises(ValueError, match=message):
            HiddenQuadraticModel(**options)


def test_equations_with_a_hidden_variable_forecast_what_quadratic_ones_cannot(hidden_model):
    assert replace(hidden_model, round_errors=np.zeros(2)).weaknesses() == [
        "no round of smoothing improved forecasts (quadratic_hidden.rounds)"
    ]
    np.testing.assert_allclose(hidden_model.consistency, 1, atol=0.25)
    washout, _ = washouts_of(NOISY_LONG[4:, :850, :2], 30, 55)
    truth = np.concatenate(
        [LONG_LORENZ[4:, end : end + 40, :2].transpose(1, 2, 0) for end in range(30, 850, 55)],
        axis=2,
    )
    scale = LORENZ_SCALE[:2, np.newaxis]
    outputs = hidden_model.advance(hidden_model.start(washout), 40)[0]
    off = np.sqrt(np.square((outputs - truth) / scale).mean(axis=(0, 1)))
    blind = FilteredQuadraticModel(members=20).fit(NOISY_LONG[:4, :, :2], HIDDEN_CASE)
    missed = blind.advance(blind.start(washout), 40)[0]
    missed = np.sqrt(np.square((missed - truth) / scale).mean(axis=(0, 1)))
    assert np.median(off) < 0.1
    assert np.median(missed) > 5 * np.median(off)
    assert_depends_on_its_washout_alone(hidden_model, washout[..., :5], 12, HIDDEN_CASE)
    refitted = list(hidden_model.leave_one_out(NOISY_LONG[:4, :, :2], HIDDEN_CASE, 30))
    assert len(refitted) == 4
    for other in refitted:
        again = other.advance(other.start(washout), 20)[0]
        assert np.median(np.abs((again - outputs[:20]) / scale).max(axis=(0, 1))) < 0.3


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"round_errors": np.array([-1.0, -1.5])}, "lowered the log10 square error .* by 0.5"),
        ({"model_error": np.array([0.01, 0.5])}, "the smoother follows its own equations"),
        ({"explained": 0.9}, "hidden variables explain little"),
        ({"consistency": np.array([1.0, 2.0])}, "1 to 2 times the expected"),
        ({"rates": np.array([0.8, 5.5])}, "on the edge of its search"),
    ],
)
def test_weak_fits_with_hidden_variables_are_told(fields, message):
    sound = {
        "round_errors": np.array([-1.0, -1.01]),
        "model_error": np.array([0.5, 0.5]),
        "errors": np.ones(2),
        "explained": 0.1,
        "consistency": np.ones(2),
        "rates": np.array([1.65, 2.93]),
    }
    model = HiddenQuadraticModel(**HIDDEN_OPTIONS)
    assert model.with_fitted(**sound).weaknesses() == []
    (weakness,) = model.with_fitted(**{**sound, **fields}).weaknesses()
    assert re.search(message, weakness)


def test_smoothing_brings_equations_without_hidden_variables_nearer_to_the_true_ones():
    noise = 0.1 * LORENZ_SCALE * np.random.default_rng(8).normal(size=LONG_LORENZ.shape)
    noisy = LONG_LORENZ + noise
    case = replace(HIDDEN_CASE, system=Lorenz63())
    options = {"hidden": 0, "members": 20}
    first, last = (
        HiddenQuadraticModel(rounds=rounds, **options).fit(noisy[:4], case) for rounds in (0, 4)
    )
    assert last.round_errors[0] == first.round_errors[0]
    assert np.argmin(last.round_errors) > 0
    states = LONG_LORENZ[4].T
    truth = case.system.right_hand_side(states)
    off = [
        np.square(model.system.right_hand_side(states) - truth).mean() for model in (first, last)
    ]
    assert off[1] < 0.5 * off[0]
    washout, _ = washouts_of(noisy[4:, :800], 30, 55)
    assert_depends_on_its_washout_alone(last, washout[..., :5], 12, case)
    assert len(list(last.leave_one_out(noisy[:4], case, 30))) == 4
    assert not any("hidden" in weakness for weakness in last.weaknesses())


def test_an_observable_that_follows_is_learnt_from_all_variables():
    class WithEnergy(OfTwo):
        dimension = 3

        def observable(self, state):
            return np.array(state[1])

    energy = np.square(NOISY_LONG / LORENZ_SCALE).sum(axis=2)
    series = np.stack([NOISY_LONG[..., 0], energy, NOISY_LONG[..., 1]], axis=2)
    case = replace(HIDDEN_CASE, system=WithEnergy())
    options = {**HIDDEN_OPTIONS, "rounds": 0, "observable_follows": True}
    model = HiddenQuadraticModel(**options).fit(series[:4], case)
    assert model.place == 1
    washout, _ = washouts_of(series[4:, :800], 30, 55)
    outputs = model.advance(model.start(washout), 10)[0]
    assert outputs.shape[1] == 3
    truth = np.concatenate(
        [
            np.square(LONG_LORENZ[4:, end : end + 10] / LORENZ_SCALE).sum(axis=2).T
            for end in range(30, 800, 55)
        ],
        axis=1,
    )
    assert np.median(np.abs(outputs[:, 1] - truth)) < 0.05 * truth.std()
    assert_depends_on_its_washout_alone(model, washout[..., :5], 12, case)
    # quadratic terms conserve it where they are asked to, and not of themselves
    conserving = HiddenQuadraticModel(**options, conserved=True).fit(series[:4], case)
    states = np.random.default_rng(4).normal(size=(3, 50))
    changes = []
    for fitted in (model, conserving):
        quadratic = np.where(np.arange(10)[:, np.newaxis] < 4, 0.0, fitted.coefficients)
        tendency = PolynomialSystem(quadratic, 2, Lorenz63()).right_hand_side(states)
        xx, xy, xz, yy, yz, zz = fitted.follows[4:]
        form = np.array([[2 * xx, xy, xz], [xy, 2 * yy, yz], [xz, yz, 2 * zz]])
        changes.append(np.abs(np.sum(states * (form @ tendency), axis=0)).max())
    assert changes[1] < 1e-8 * changes[0]
    with pytest.raises(ValueError, match="one of whose components is the observable"):
        HiddenQuadraticModel(**options).fit(series[:4, :, ::-1] + 1.0, replace(case, system=SYSTEM))


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
