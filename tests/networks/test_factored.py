"""Readouts that are linear in factors of parameters."""

from dataclasses import replace

import numpy as np
import pytest

from burstcast.networks.dynamics import Dynamics
from burstcast.networks.factored import (
    FactoredSeries,
    FactoredStates,
    driven_neurons,
    forecast_under,
)
from burstcast.networks.network import EchoStateNetwork
from burstcast.networks.reservoir import make_reservoir
from burstcast.networks.training import collect, train, train_leaving_one_out
from burstcast.networks.validation import validate
from burstcast.networks.validation_strategies.base import ValidationPlan
from burstcast.networks.validation_strategies.registry import make_strategy

WASHOUT, BETA = 20, 1e-6


@pytest.fixture(scope="module")
def dynamics(reservoir):
    return Dynamics(reservoir, 0.5, 0.6)


@pytest.fixture(scope="module")
def training(signal):
    """Series of five, the parameter of which switches at random."""
    observed = np.ascontiguousarray(signal.transpose(2, 0, 1))
    generator = np.random.default_rng(4)
    changes = generator.random((5, 899)) < 0.03
    factors = np.array([[-1.0, 1.0], [0.2, 0.04], [1.0, 1.0]])[np.cumsum(changes, axis=1) % 3]
    return FactoredSeries(observed, np.ptp(observed, axis=(0, 1)), factors=factors)


@pytest.fixture(scope="module")
def readout(dynamics, training):
    return train(dynamics, training, washout=WASHOUT, tikhonov=BETA)


@pytest.fixture(scope="module")
def states(dynamics, training):
    """Reservoir states from which closed loops start, before step 300."""
    return collect(dynamics, training, washout=WASHOUT, keep=[300]).states[300]


def dense_readout(dynamics, training, rows=slice(None)):
    """Ridge regression on all features written out, the bias column among them."""
    scaled = training.observed.transpose(1, 2, 0) / training.input_range[:, np.newaxis]
    state, after = None, []  # one input after the other
    for step in range(training.length - 1):
        state = dynamics.open_loop(scaled[step : step + 1], state)
        after.append(state.T)
    states = np.stack(after, axis=1)[rows, WASHOUT - 1 :]
    factors = training.factors[rows, WASHOUT - 1 :]
    driven = states[:, :, driven_neurons(dynamics.reservoir)]
    blocks = [
        states,
        *(factors[..., [index]] * driven for index in range(factors.shape[2])),
        factors,
    ]
    features = np.concatenate([*blocks, np.ones((*states.shape[:2], 1))], axis=2)
    features = features.reshape(-1, features.shape[2])
    targets = training.observed[rows, WASHOUT:].reshape(len(features), -1)
    # the normal equations as an augmented least-squares problem, which squares no condition number
    augmented = np.vstack([features, np.sqrt(BETA) * np.eye(features.shape[1])])
    right = np.vstack([targets, np.zeros((features.shape[1], targets.shape[1]))])
    return np.linalg.lstsq(augmented, right)[0], features, targets


def test_the_readout_is_that_of_dense_least_squares_also_without_one_series(
    dynamics, training, readout
):
    expected, features, targets = dense_readout(dynamics, training)
    assert readout.weights.shape == expected.shape
    np.testing.assert_allclose(readout.weights, expected, rtol=1e-5, atol=1e-6)
    # and what matters: the same fit, which the plain readout does not reach
    error = np.sqrt(np.mean((features @ readout.weights - targets) ** 2))
    assert error == pytest.approx(np.sqrt(np.mean((features @ expected - targets) ** 2)), rel=1e-9)
    result = list(train_leaving_one_out(dynamics, training, washout=WASHOUT, tikhonov=BETA))
    for row in (0, 3):
        others = [other for other in range(5) if other != row]
        expected, _, _ = dense_readout(dynamics, training, others)
        np.testing.assert_allclose(result[row].weights, expected, rtol=1e-4, atol=1e-5)


def test_the_closed_loop_under_a_schedule_is_that_of_a_plain_loop(
    dynamics, training, readout, states
):
    """Step by step in numpy: r <- tanh(W_in [u; b] + W r), u = [r; q r; q; 1] W_out."""
    factors = training.factors[:, 299 : 299 + 60].transpose(1, 2, 0)
    network = EchoStateNetwork(dynamics, readout, training.input_range)
    result, last = forecast_under(network, states, factors)
    reservoir, layout = dynamics.reservoir, FactoredStates.of(dynamics.reservoir, 2)
    recurrent = dynamics.spectral_radius * reservoir.recurrent.toarray()
    state = states
    for step, in_force in enumerate(factors):
        features = layout.features(state, in_force)
        output = readout.weights[:-1].T @ features + readout.weights[-1][:, np.newaxis]
        np.testing.assert_allclose(result[step], output, atol=1e-6)
        inputs = np.vstack(
            [output / training.input_range[:, np.newaxis], np.full((1, 5), reservoir.input_bias)]
        )
        fed = reservoir.input_weight[:, np.newaxis] * inputs[reservoir.input_column]
        state = np.tanh(dynamics.input_scaling * fed + recurrent @ state)
    np.testing.assert_allclose(last, state, atol=1e-6)


def test_a_loop_that_diverges_changes_no_other(dynamics, training, readout, states):
    factors = training.factors[:, 299:349].transpose(1, 2, 0)
    network = EchoStateNetwork(dynamics, readout, training.input_range)
    together, _ = forecast_under(network, states, factors)
    result, _ = forecast_under(network, np.where(np.arange(5) == 2, np.nan, states), factors)
    assert np.isnan(result[..., 2]).all()
    np.testing.assert_array_equal(np.delete(result, 2, axis=2), np.delete(together, 2, axis=2))


def test_neurons_that_are_not_driven_are_those_that_settle():
    reservoir = make_reservoir(300, 3, 2, 0.1, np.random.default_rng(2))
    dynamics = Dynamics(reservoir, 0.5, 0.6)
    inputs = np.random.default_rng(3).normal(size=(200, 3, 1))
    first = dynamics.open_loop(inputs[:150])
    moved = (first != dynamics.open_loop(inputs[150:], first)).ravel()
    driven = driven_neurons(reservoir)
    assert 0 < 300 - len(driven) < 100
    assert set(np.flatnonzero(moved)) == set(driven)


@pytest.mark.parametrize("name", ["RV", "SSV"])
def test_validation_is_that_of_plain_closed_loops(dynamics, training, name):
    plan, strategy = ValidationPlan(WASHOUT, 25, series=3, intervals=4), make_strategy(name)
    (fold,) = strategy.folds(plan, 5, 900)
    (validation,) = validate(dynamics, training, lambda state: state[0], plan, [BETA], [strategy])
    stop = fold.trained[0].stop
    observed, factors = training.observed[:, :stop], training.factors[:, : stop - 1]
    part = FactoredSeries(observed, training.input_range, factors=factors)
    readout = train(dynamics, part, washout=WASHOUT, tikhonov=BETA)
    network = EchoStateNetwork(dynamics, readout, training.input_range)
    expected = []
    for start in fold.starts:
        for row in fold.series:
            washout = training.observed[row, :start, :, np.newaxis]
            states = network.washout(washout)
            in_force = training.factors[row, start - 1 : start + 24, :, np.newaxis]
            outputs, _ = forecast_under(network, states, in_force)
            truth = training.observed[row, start : start + 25, 0]
            expected.append(np.log10(np.mean((outputs[:, 0, 0] - truth) ** 2)))
    np.testing.assert_allclose(validation.log_errors, expected, rtol=1e-7)


def test_factors_and_weights_that_do_not_fit_are_refused(dynamics, training):
    with pytest.raises(ValueError, match=r"factors of the shape \(5, 899, factors\)"):
        replace(training, factors=training.factors[:, 1:])
    layout = FactoredStates.of(dynamics.reservoir, 1)
    with pytest.raises(ValueError, match="has no 151 weights"):
        layout.weights_at(np.zeros((151, 4)), np.zeros(1))
