"""The open loop over the training series against states that are all kept, and plain sums."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.esn.dynamics import Dynamics
from burstcast.esn.readout import solve_ridge
from burstcast.esn.reservoir import make_reservoir
from burstcast.esn.training import TrainingSeries, collect, train, train_leaving_one_out

NEURONS, DIMENSION, SERIES, LENGTH, WASHOUT = 23, 3, 4, 90, 11
RESERVOIR = make_reservoir(NEURONS, DIMENSION, 5, 0.1, np.random.default_rng(4))
DYNAMICS = Dynamics(RESERVOIR, 0.8, 0.7, "scipy")
OBSERVED = np.random.default_rng(8).normal(size=(SERIES, LENGTH, DIMENSION)).cumsum(axis=1)
RANGE = np.array([3.0, 0.5, 11.0])
TRAINING = TrainingSeries(observed=OBSERVED, input_range=RANGE)


def textbook_states(dynamics=DYNAMICS, observed=OBSERVED, input_range=RANGE):
    """States by series and step with dense matrices: entry j has seen the inputs before step j."""
    reservoir = dynamics.reservoir
    recurrent = dynamics.spectral_radius * reservoir.recurrent.toarray()
    inputs = np.zeros((reservoir.neurons, observed.shape[2] + 1))
    for neuron in range(reservoir.neurons):
        weight = dynamics.input_scaling * reservoir.input_weight[neuron]
        inputs[neuron, reservoir.input_column[neuron]] = weight
    states = np.zeros((*observed.shape[:2], reservoir.neurons))
    for number, series in enumerate(observed):
        state = np.zeros(reservoir.neurons)
        for step in range(1, len(series)):
            given_input = np.append(series[step - 1] / input_range, reservoir.input_bias)
            state = np.tanh(inputs @ given_input + recurrent @ state)
            states[number, step] = state
    return states


STATES = textbook_states()


def test_a_quadratic_readout_is_trained_on_squares():
    dynamics = Dynamics(RESERVOIR, 0.8, 0.7, "scipy", readout="quadratic")
    found = collect(dynamics, TRAINING, washout=WASHOUT, keep=[LENGTH - 1])
    features = STATES[:, WASHOUT:].reshape(-1, NEURONS).copy()
    features[:, 1::2] = features[:, 1::2] ** 2
    np.testing.assert_allclose(found.moments.mean_state, features.mean(axis=0), atol=1e-14)
    centred = features - features.mean(axis=0)
    np.testing.assert_allclose(
        np.tril(found.moments.gram), np.tril(centred.T @ centred), atol=1e-11
    )
    # closed loops start from the states themselves
    np.testing.assert_allclose(found.states[LENGTH - 1], STATES[:, -1].T, atol=1e-14)


def rows(first, stop):
    """States and targets of the steps ``first`` to ``stop - 1`` of all series."""
    return (
        STATES[:, first:stop].reshape(-1, NEURONS),
        OBSERVED[:, first:stop].reshape(-1, DIMENSION),
    )


def assert_moments(moments, first, stop):
    states, targets = rows(first, stop)
    assert moments.count == len(states)
    state_mean, target_mean = states.mean(axis=0), targets.mean(axis=0)
    np.testing.assert_allclose(moments.mean_state, state_mean, rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(moments.mean_target, target_mean, rtol=1e-12, atol=1e-13)
    centred = states - state_mean
    np.testing.assert_allclose(
        np.tril(moments.gram), np.tril(centred.T @ centred), rtol=0, atol=1e-12
    )
    np.testing.assert_allclose(
        moments.cross, centred.T @ (targets - target_mean), rtol=0, atol=1e-10
    )


def test_moments_are_those_of_all_states_after_the_washout():
    collected = collect(DYNAMICS, TRAINING, washout=WASHOUT)
    assert_moments(collected.moments, WASHOUT, LENGTH)
    assert collected.snapshots == {}
    assert collected.states == {}


@settings(max_examples=25, deadline=None)
@given(st.data())
def test_snapshots_last_steps_and_kept_states(data):
    washout = data.draw(st.integers(1, LENGTH - 3))
    last = data.draw(st.integers(washout + 1, LENGTH - 1))
    snapshots = data.draw(st.lists(st.integers(washout + 1, last), max_size=3))
    keep = data.draw(st.lists(st.integers(washout, last), max_size=5))
    collected = collect(
        DYNAMICS, TRAINING, washout=washout, snapshots=snapshots, last=last, keep=keep
    )
    assert_moments(collected.moments, washout, last + 1)
    assert set(collected.snapshots) == set(snapshots)
    for snapshot, moments in collected.snapshots.items():
        assert_moments(moments, washout, snapshot)
    assert set(collected.states) == set(keep)
    for step, states in collected.states.items():
        np.testing.assert_allclose(states, STATES[:, step].T, rtol=0, atol=1e-13)


def test_the_snapshot_is_bit_for_bit_a_run_that_ends_there():
    long = collect(DYNAMICS, TRAINING, washout=WASHOUT, snapshots=[60], keep=[60])
    short = collect(DYNAMICS, TRAINING, washout=WASHOUT, snapshots=[60], last=60, keep=[60])
    for name in ("mean_state", "mean_target", "gram", "cross"):
        np.testing.assert_array_equal(
            getattr(long.snapshots[60], name), getattr(short.snapshots[60], name)
        )
    np.testing.assert_array_equal(long.states[60], short.states[60])


def test_the_series_are_not_changed_by_training_on_one_of_them():
    observed = OBSERVED[:1].copy()
    collect(DYNAMICS, TrainingSeries(observed, RANGE), washout=WASHOUT)
    np.testing.assert_array_equal(observed, OBSERVED[:1])


def test_many_panels():
    # more columns than fit into a panel, and a batch that does not divide them
    observed = np.random.default_rng(3).normal(size=(7, 800, DIMENSION))
    collected = collect(
        DYNAMICS, TrainingSeries(observed, RANGE), washout=5, snapshots=[611], keep=[5, 143, 799]
    )
    states = textbook_states(observed=observed)
    for step in (5, 143, 799):
        np.testing.assert_allclose(collected.states[step], states[:, step].T, rtol=0, atol=1e-13)
    for moments, stop in ((collected.moments, 800), (collected.snapshots[611], 611)):
        flat = states[:, 5:stop].reshape(-1, NEURONS)
        centred = flat - flat.mean(axis=0)
        assert moments.count == len(flat)
        np.testing.assert_allclose(
            np.tril(moments.gram), np.tril(centred.T @ centred), rtol=1e-10, atol=1e-10
        )


@pytest.mark.parametrize(
    "arguments",
    [
        {"washout": WASHOUT, "keep": [WASHOUT - 1]},
        {"washout": WASHOUT, "keep": [LENGTH]},
        {"washout": WASHOUT, "keep": [50], "last": 49},
        {"washout": WASHOUT, "last": WASHOUT},
        {"washout": WASHOUT, "last": LENGTH},
        {"washout": WASHOUT, "snapshots": [WASHOUT]},
        {"washout": WASHOUT, "snapshots": [LENGTH]},
        {"washout": LENGTH},
        {"washout": 0},
    ],
)
def test_steps_outside_of_the_series_are_refused(arguments):
    with pytest.raises(ValueError, match=r"outside of the training series|at least one step"):
        collect(DYNAMICS, TRAINING, **arguments)


def test_training_is_the_papers_ridge_regression():
    tikhonov = 1e-6
    states, targets = rows(WASHOUT, LENGTH)
    design = np.hstack([states, np.ones((len(states), 1))])
    matrix = design.T @ design + tikhonov * np.eye(NEURONS + 1)
    weights = np.linalg.solve(matrix, design.T @ targets)
    readout = train(DYNAMICS, TRAINING, washout=WASHOUT, tikhonov=tikhonov)
    np.testing.assert_allclose(readout.weights, weights, rtol=1e-6, atol=1e-8)
    assert readout.tikhonov == tikhonov
    same = solve_ridge(collect(DYNAMICS, TRAINING, washout=WASHOUT).moments, tikhonov)
    np.testing.assert_array_equal(readout.weights, same.weights)


def test_series_say_how_many_and_how_long_they_are():
    assert (TRAINING.series, TRAINING.length) == (SERIES, LENGTH)


def test_leaving_one_out_is_training_on_the_others():
    readouts = train_leaving_one_out(DYNAMICS, TRAINING, washout=WASHOUT, tikhonov=1e-4)
    for row, readout in enumerate(readouts):
        others = TrainingSeries(np.delete(OBSERVED, row, axis=0), RANGE)
        expected = train(DYNAMICS, others, washout=WASHOUT, tikhonov=1e-4)
        np.testing.assert_allclose(readout.weights, expected.weights, rtol=1e-7, atol=1e-9)
        assert readout.tikhonov == 1e-4
    assert row == SERIES - 1


def test_leaving_one_out_does_not_see_the_one():
    other = OBSERVED.copy()
    other[2] = np.random.default_rng(1).normal(size=OBSERVED[2].shape)
    first, second = (
        list(
            train_leaving_one_out(
                DYNAMICS, TrainingSeries(observed, RANGE), washout=WASHOUT, tikhonov=1e-4
            )
        )
        for observed in (OBSERVED, other)
    )
    np.testing.assert_array_equal(first[2].weights, second[2].weights)
    assert not np.array_equal(first[1].weights, second[1].weights)


def test_leaving_one_out_takes_two_series():
    single = TrainingSeries(OBSERVED[:1], RANGE)
    with pytest.raises(ValueError, match="two training series"):
        next(train_leaving_one_out(DYNAMICS, single, washout=WASHOUT, tikhonov=1e-4))
