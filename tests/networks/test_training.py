"""Readouts and their training against states that are all kept, and plain sums."""

from dataclasses import replace
from functools import reduce

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.base.left_out import LeftOut
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.readout import Moments, MomentsAccumulator, solve_ridge
from burstcast.networks.reservoir import make_reservoir
from burstcast.networks.training import TrainingSeries, collect, train, train_leaving_one_out
from helpers_library import textbook_step


def accumulate(states, targets, edges=()):
    accumulator = MomentsAccumulator(states.shape[0], targets.shape[0])
    for start, stop in zip([0, *edges], [*edges, states.shape[1]], strict=True):
        accumulator.add(states[:, start:stop], targets[:, start:stop])
    return accumulator.moments()


def assert_moments(moments, states, targets, atol=1e-12):
    """Against plain sums over ``states`` and ``targets``, ``(..., rows)``."""
    centred = states - states.mean(axis=1, keepdims=True)
    centred_targets = targets - targets.mean(axis=1, keepdims=True)
    assert moments.count == states.shape[1]
    means = {"rtol": 1e-12, "atol": 1e-14}
    np.testing.assert_allclose(moments.mean_state, states.mean(axis=1), **means)
    np.testing.assert_allclose(moments.mean_target, targets.mean(axis=1), **means)
    gram, cross = np.tril(centred @ centred.T), centred @ centred_targets.T
    np.testing.assert_allclose(np.tril(moments.gram), gram, rtol=0, atol=atol)
    np.testing.assert_allclose(moments.cross, cross, rtol=0, atol=100 * atol)


def qr_weights(states, targets, tikhonov):
    """Least squares on [R; sqrt(beta) I], the reference that never forms a Gram matrix."""
    rows = np.vstack([states, np.ones(states.shape[1])]).T
    size = rows.shape[1]
    augmented = np.vstack([rows, np.sqrt(tikhonov) * np.eye(size)])
    right = np.vstack([targets.T, np.zeros((size, targets.shape[0]))])
    orthogonal, triangle = scipy.linalg.qr(augmented, mode="economic")
    return scipy.linalg.solve_triangular(triangle, orthogonal.T @ right)


def objective(weights, states, targets, tikhonov):
    residual = weights[:-1].T @ states + weights[-1][:, None] - targets
    return (residual**2).sum() + tikhonov * (weights**2).sum()


@pytest.fixture(scope="module")
def training(reservoir, signal):
    """Reservoir states and targets, (neurons, rows) and (dimension, rows)."""
    dynamics = Dynamics(reservoir, 0.4, 0.5, "scipy")
    (panel,) = dynamics.state_panels(
        signal[50:599] / np.ptp(signal, axis=(0, 2))[:, None], columns_per_panel=10**6
    )
    targets = signal[51:600].transpose(1, 0, 2).reshape(signal.shape[1], -1)
    return panel.columns, targets


@given(first=st.integers(1, 30), second=st.integers(1, 30), seed=st.integers(0, 1000))
@settings(max_examples=60)
def test_moments_of_parts_merge_to_those_of_the_whole(first, second, seed):
    generator = np.random.default_rng(seed)
    states = generator.uniform(-1, 1, size=(5, first + second))
    states[:, :first] += 1  # parts with means of their own
    targets = generator.normal(size=(2, first + second))
    part = accumulate(states[:, :first], targets[:, :first])
    two = accumulate(states[:, first:], targets[:, first:])
    kept = part.gram.copy()
    assert_moments(part.merge(two), states, targets)
    assert_moments(two.merge(part), states, targets)
    np.testing.assert_array_equal(part.gram, kept)


def test_nothing_that_is_given_is_changed(training):
    states, targets = (values.copy() for values in training)
    moments = accumulate(states, targets, [500])
    kept, once = moments.gram.copy(), solve_ridge(moments, 1e-9)
    solve_ridge(moments, 1e-2)
    observed = OBSERVED[:1].copy()
    collect(DYNAMICS, TrainingSeries(observed, RANGE), washout=WASHOUT)
    for now, before in (
        *((states, training[0]), (targets, training[1]), (observed, OBSERVED[:1])),
        *((moments.gram, kept), (solve_ridge(moments, 1e-9).weights, once.weights)),
    ):
        np.testing.assert_array_equal(now, before)


@pytest.mark.parametrize("tikhonov", [1e-6, 1.0, 1e3])
def test_weights_equal_those_of_qr(training, tikhonov):
    """The output bias is regularised, too, which shows where beta is as large as the sums."""
    states, targets = training
    readout = solve_ridge(accumulate(states, targets, [700, 900]), tikhonov)
    expected = qr_weights(states, targets, tikhonov)
    assert readout.solver == "cholesky"
    assert readout.tikhonov == tikhonov
    np.testing.assert_allclose(
        readout.weights, expected, rtol=0, atol=1e-6 * np.abs(expected).max()
    )


def test_smallest_regularisation_reaches_the_minimum_of_qr(training):
    states, targets = training
    readout = solve_ridge(accumulate(states, targets, [700, 900]), 1e-12)
    reference = qr_weights(states, targets, 1e-12)
    assert objective(readout.weights, states, targets, 1e-12) == pytest.approx(
        objective(reference, states, targets, 1e-12), rel=1e-6
    )
    predicted = readout.weights[:-1].T @ states + readout.weights[-1][:, None]
    expected = reference[:-1].T @ states + reference[-1][:, None]
    noise = (targets - expected).std()
    assert np.sqrt(((predicted - expected) ** 2).mean()) < 1e-3 * noise


def test_indefinite_matrix_is_solved_by_ldl():
    # What rounding does to a Gram matrix: a small negative eigenvalue.
    generator = np.random.default_rng(2)
    basis, _ = np.linalg.qr(generator.normal(size=(8, 8)))
    gram = basis @ np.diag([1e4, 1e2, 1, 1, 1e-2, 1e-3, 1e-4, -1e-6]) @ basis.T
    mean_state, mean_target = generator.normal(size=8), generator.normal(size=2)
    lower, cross = np.asfortranarray(np.tril(gram)), generator.normal(size=(8, 2))
    moments = Moments(100, mean_state, mean_target, lower, cross)
    readout = solve_ridge(moments, 1e-12)
    assert readout.solver == "ldl"
    matrix = gram + 1e-12 * np.eye(8) + 1e-12 * np.outer(moments.mean_state, moments.mean_state)
    expected = np.linalg.solve(matrix, moments.cross)
    np.testing.assert_allclose(readout.weights[:-1], expected, rtol=1e-3)
    condition = np.linalg.cond(matrix, 1)
    assert 0.5 / condition < readout.reciprocal_condition < 20 / condition


def test_reciprocal_condition_is_known_and_has_no_digits_that_depend_on_where_memory_lies():
    moments = Moments(
        10, np.zeros(3), np.zeros(1), np.asfortranarray(np.diag([4.0, 2.0, 1.0])), np.ones((3, 1))
    )
    readout = solve_ridge(moments, 0.0)
    assert readout.reciprocal_condition == pytest.approx(0.25)
    np.testing.assert_allclose(readout.weights[:, 0], [0.25, 0.5, 1.0, 0.0])
    states = np.random.default_rng(3).normal(size=(30, 40))
    gram = np.asfortranarray(states @ states.T)
    moments = Moments(40, np.zeros(30), np.zeros(1), gram, np.ones((30, 1)))
    result = solve_ridge(moments, 1e-6).reciprocal_condition
    assert result == float(f"{result:.3g}")


def test_bad_training_data_raise(training):
    states, targets = training
    moments = accumulate(states, targets)
    spoilt = states.copy()
    spoilt[3, 7] = np.nan
    spoilt_targets = targets.copy()
    spoilt_targets[0, 0] = np.inf
    no_rows = MomentsAccumulator(3, 1)
    no_rows.add(np.empty((3, 0)), np.empty((1, 0)))
    bad_gram = moments.gram.copy(order="F")
    bad_gram[5, 2] = np.inf
    bad_moments = replace(moments, gram=bad_gram)
    calls = [
        (lambda: accumulate(spoilt, targets), "not finite"),
        (lambda: accumulate(states, spoilt_targets), "not finite"),
        (lambda: MomentsAccumulator(3, 1).add(states, targets), "do not fit"),
        (lambda: MomentsAccumulator(150, 4).add(states, targets[:, 1:]), "do not fit"),
        (no_rows.moments, "no training data"),
        (lambda: solve_ridge(moments, -1.0), "Tikhonov"),
        (lambda: solve_ridge(moments, np.nan), "Tikhonov"),
        (lambda: solve_ridge(bad_moments, 1e-6), "moments of the training"),
        (lambda: moments.merge(accumulate(states[:9], targets)), "do not merge"),
    ]
    for call, reason in calls:
        with pytest.raises(ValueError, match=reason):
            call()
    singular = Moments(5, np.zeros(2), np.zeros(1), np.zeros((2, 2), order="F"), np.ones((2, 1)))
    with pytest.raises(np.linalg.LinAlgError, match="singular"):
        solve_ridge(singular, 0.0)


# -- the open loop over the training series --------------------------------------------------------

NEURONS, DIMENSION, SERIES, LENGTH, WASHOUT = 23, 3, 4, 90, 11
RESERVOIR = make_reservoir(NEURONS, DIMENSION, 5, 0.1, np.random.default_rng(4))
DYNAMICS = Dynamics(RESERVOIR, 0.8, 0.7, "scipy")
OBSERVED = np.random.default_rng(8).normal(size=(SERIES, LENGTH, DIMENSION)).cumsum(axis=1)
RANGE = np.array([3.0, 0.5, 11.0])
TRAINING = TrainingSeries(observed=OBSERVED, input_range=RANGE)


def textbook_states(dynamics=DYNAMICS, observed=OBSERVED, input_range=RANGE):
    """States by series and step: entry j has seen the inputs before step j."""
    states = np.zeros((*observed.shape[:2], dynamics.reservoir.neurons))
    for state, series in zip(states, observed, strict=True):
        for step in range(1, len(series)):
            state[step] = textbook_step(dynamics, series[step - 1] / input_range, state[step - 1])
    return states


STATES = textbook_states()


def test_a_quadratic_readout_is_trained_on_squares():
    dynamics = Dynamics(RESERVOIR, 0.8, 0.7, "scipy", readout="quadratic")
    result = collect(dynamics, TRAINING, washout=WASHOUT, keep=[LENGTH - 1])
    features = np.where(np.arange(NEURONS) % 2, STATES**2, STATES)
    assert_moments(result.moments, *rows(WASHOUT, LENGTH, features), 1e-11)
    # closed loops start from the states themselves
    np.testing.assert_allclose(result.states[LENGTH - 1], STATES[:, -1].T, atol=1e-14)


def rows(first, stop, states=STATES, observed=OBSERVED):
    """States and targets of the steps ``first`` to ``stop - 1`` of all series, ``(..., rows)``."""
    return tuple(part[:, first:stop].reshape(-1, part.shape[2]).T for part in (states, observed))


@settings(max_examples=25)
@given(st.data())
def test_snapshots_last_steps_and_kept_states(data):
    washout = data.draw(st.integers(1, LENGTH - 3))
    last = data.draw(st.integers(washout + 1, LENGTH - 1))
    snapshots = data.draw(st.lists(st.integers(washout + 1, last), max_size=3))
    keep = data.draw(st.lists(st.integers(washout, last), max_size=5))
    collected = collect(
        DYNAMICS, TRAINING, washout=washout, snapshots=snapshots, last=last, keep=keep
    )
    assert_moments(collected.moments, *rows(washout, last + 1))
    assert set(collected.snapshots) == set(snapshots)
    for snapshot, moments in collected.snapshots.items():
        assert_moments(moments, *rows(washout, snapshot))
    assert set(collected.states) == set(keep)
    for step, states in collected.states.items():
        np.testing.assert_allclose(states, STATES[:, step].T, rtol=0, atol=1e-13)


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
        assert_moments(moments, *rows(5, stop, states, observed), 1e-10)


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
    states, targets = rows(WASHOUT, LENGTH)
    readout = train(DYNAMICS, TRAINING, washout=WASHOUT, tikhonov=1e-6)
    weights = qr_weights(states, targets, 1e-6)
    np.testing.assert_allclose(readout.weights, weights, rtol=1e-6, atol=1e-8)
    assert readout.tikhonov == 1e-6


def test_leaving_one_out_is_training_on_the_others():
    readouts = train_leaving_one_out(DYNAMICS, TRAINING, washout=WASHOUT, tikhonov=1e-4)
    for row, readout in enumerate(readouts):
        others = TrainingSeries(np.delete(OBSERVED, row, axis=0), RANGE)
        expected = train(DYNAMICS, others, washout=WASHOUT, tikhonov=1e-4)
        np.testing.assert_allclose(readout.weights, expected.weights, rtol=1e-7, atol=1e-9)
        assert readout.tikhonov == 1e-4
    assert row == SERIES - 1
    assert (TRAINING.series, TRAINING.length) == (SERIES, LENGTH)
    single = TrainingSeries(OBSERVED[:1], RANGE)
    with pytest.raises(ValueError, match="two training series"):
        next(train_leaving_one_out(DYNAMICS, single, washout=WASHOUT, tikhonov=1e-4))


@pytest.mark.parametrize("offset", [None, np.array([0.3, -0.2, 0.1])], ids=["plain", "offset"])
@pytest.mark.parametrize("kind", ["linear", "quadratic"])
def test_series_driven_side_by_side_have_the_bits_of_each_alone(kind, offset):
    """More series than are driven at a time, of unequal lengths, over several panels."""
    generator = np.random.default_rng(5)
    observed = np.cumsum(generator.normal(size=(19, 2300, 3)), axis=1) / 10
    observed[3, 1200:], observed[17, 40:] = np.nan, np.nan
    series = TrainingSeries(observed, np.array([1.0, 2.0, 3.0]), offset)
    given = observed.copy()
    reservoir = make_reservoir(20, 3, 4, 0.1, np.random.default_rng(0))
    dynamics = Dynamics(reservoir, 0.5, 0.3, leak_rate=0.7, readout=kind)
    alone = [
        collect(dynamics, series.part(slice(row, row + 1)), washout=30).moments
        for row in range(series.series)
    ]
    left_out = [[2], [0], [1, 2], [18, 4], [7]]  # in no order
    rows = [LeftOut(np.array(each), np.array(each)) for each in left_out]
    readouts = train_leaving_one_out(dynamics, series, washout=30, tikhonov=1e-6, left_out=rows)
    for without, readout in zip(left_out, readouts, strict=True):
        others = [moments for row, moments in enumerate(alone) if row not in without]
        expected = solve_ridge(reduce(Moments.merge, others), 1e-6)
        np.testing.assert_array_equal(readout.weights, expected.weights)
    np.testing.assert_array_equal(observed, given)


@pytest.mark.parametrize("overwrite", [False, True])
def test_sums_overwrite_states_only_where_they_may(overwrite):
    states, targets = map(np.ascontiguousarray, rows(WASHOUT, LENGTH))
    expected, given = accumulate(states, targets), states.copy()
    accumulator = MomentsAccumulator(len(states), len(targets))
    accumulator.add(given, targets, overwrite=overwrite)
    np.testing.assert_array_equal(accumulator.moments().gram, expected.gram)
    assert np.array_equal(given, states) != overwrite
