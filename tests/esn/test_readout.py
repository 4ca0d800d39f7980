import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.esn.dynamics import Dynamics
from burstcast.esn.readout import Moments, MomentsAccumulator, _symmetric_norm, solve_ridge


def accumulate(states, targets, edges=()):
    accumulator = MomentsAccumulator(states.shape[0], targets.shape[0])
    for start, stop in zip([0, *edges], [*edges, states.shape[1]], strict=True):
        accumulator.add(states[:, start:stop], targets[:, start:stop])
    return accumulator.moments()


def assert_moments_close(moments, states, targets, tolerance=1e-12):
    centred = states - states.mean(axis=1, keepdims=True)
    centred_targets = targets - targets.mean(axis=1, keepdims=True)
    assert moments.count == states.shape[1]
    np.testing.assert_allclose(moments.mean_state, states.mean(axis=1), atol=tolerance)
    np.testing.assert_allclose(moments.mean_target, targets.mean(axis=1), atol=tolerance)
    scale = states.shape[1]
    gram = np.tril(moments.gram)
    np.testing.assert_allclose(gram, np.tril(centred @ centred.T), atol=tolerance * scale)
    np.testing.assert_allclose(moments.cross, centred @ centred_targets.T, atol=tolerance * scale)


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


@given(
    neurons=st.integers(1, 6),
    dimension=st.integers(1, 3),
    columns=st.integers(1, 40),
    cuts=st.lists(st.integers(0, 40), max_size=4),
    offset=st.floats(-1, 1),
    seed=st.integers(0, 1000),
)
@settings(max_examples=60, deadline=None)
def test_panels_of_any_size_give_the_same_moments(neurons, dimension, columns, cuts, offset, seed):
    generator = np.random.default_rng(seed)
    states = offset + generator.uniform(-1, 1, size=(neurons, columns))
    targets = generator.normal(size=(dimension, columns))
    edges = sorted(min(cut, columns) for cut in cuts)
    assert_moments_close(accumulate(states, targets, edges), states, targets)


@given(first=st.integers(1, 30), second=st.integers(1, 30), seed=st.integers(0, 1000))
@settings(max_examples=60, deadline=None)
def test_moments_of_parts_merge_to_those_of_the_whole(first, second, seed):
    generator = np.random.default_rng(seed)
    states = generator.uniform(-1, 1, size=(5, first + second))
    states[:, :first] += 1  # parts with means of their own
    targets = generator.normal(size=(2, first + second))
    one = accumulate(states[:, :first], targets[:, :first])
    two = accumulate(states[:, first:], targets[:, first:])
    kept = one.gram.copy()
    assert_moments_close(one.merge(two), states, targets)
    assert_moments_close(two.merge(one), states, targets)
    np.testing.assert_array_equal(one.gram, kept)


def test_snapshot_is_not_changed_by_later_rows(training):
    states, targets = training
    accumulator = MomentsAccumulator(states.shape[0], targets.shape[0])
    accumulator.add(states[:, :1000], targets[:, :1000])
    early = accumulator.moments()
    accumulator.add(states[:, 1000:], targets[:, 1000:])
    assert_moments_close(early, states[:, :1000], targets[:, :1000])
    assert_moments_close(accumulator.moments(), states, targets)


def test_states_are_not_changed(training):
    states, targets = training
    kept, kept_targets = states.copy(), targets.copy()
    accumulate(states, targets, [500])
    np.testing.assert_array_equal(states, kept)
    np.testing.assert_array_equal(targets, kept_targets)


def test_weights_equal_those_of_qr(training):
    tikhonov = 1e-6
    states, targets = training
    readout = solve_ridge(accumulate(states, targets, [700, 900]), tikhonov)
    expected = qr_weights(states, targets, tikhonov)
    assert readout.solver == "cholesky"
    assert readout.tikhonov == tikhonov
    np.testing.assert_allclose(
        readout.weights, expected, rtol=0, atol=1e-6 * np.abs(expected).max()
    )


def test_large_regularisation_includes_the_output_bias():
    # With beta of the order of the number of rows, a bias left out of the penalty would show.
    generator = np.random.default_rng(0)
    states, targets = generator.normal(size=(3, 50)) + 0.5, generator.normal(size=(2, 50)) + 2
    rows = np.vstack([states, np.ones(50)]).T
    expected = np.linalg.solve(rows.T @ rows + 40 * np.eye(4), rows.T @ targets.T)
    readout = solve_ridge(accumulate(states, targets), 40.0)
    np.testing.assert_allclose(readout.weights, expected, rtol=1e-12)


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
    moments = Moments(
        100,
        generator.normal(size=8),
        generator.normal(size=2),
        np.asfortranarray(np.tril(gram)),
        generator.normal(size=(8, 2)),
    )
    readout = solve_ridge(moments, 1e-12)
    assert readout.solver == "ldl"
    matrix = gram + 1e-12 * np.eye(8) + 1e-12 * np.outer(moments.mean_state, moments.mean_state)
    expected = np.linalg.solve(matrix, moments.cross)
    np.testing.assert_allclose(readout.weights[:-1], expected, rtol=1e-3)
    condition = np.linalg.cond(matrix, 1)
    assert 0.5 / condition < readout.reciprocal_condition < 20 / condition


def test_reciprocal_condition_of_a_known_matrix():
    moments = Moments(
        10, np.zeros(3), np.zeros(1), np.asfortranarray(np.diag([4.0, 2.0, 1.0])), np.ones((3, 1))
    )
    readout = solve_ridge(moments, 0.0)
    assert readout.reciprocal_condition == pytest.approx(0.25)
    np.testing.assert_allclose(readout.weights[:, 0], [0.25, 0.5, 1.0, 0.0])


def test_reciprocal_condition_has_no_digits_that_depend_on_where_memory_lies():
    states = np.random.default_rng(3).normal(size=(30, 40))
    gram = np.asfortranarray(states @ states.T)
    moments = Moments(40, np.zeros(30), np.zeros(1), gram, np.ones((30, 1)))
    found = solve_ridge(moments, 1e-6).reciprocal_condition
    assert found == float(f"{found:.3g}")


def test_several_regularisations_from_the_same_moments(training):
    moments = accumulate(*training)
    kept = moments.gram.copy()
    once = solve_ridge(moments, 1e-9)
    solve_ridge(moments, 1e-2)
    again = solve_ridge(moments, 1e-9)
    np.testing.assert_array_equal(once.weights, again.weights)
    np.testing.assert_array_equal(moments.gram, kept)


@pytest.mark.parametrize("neurons", [1, 5, 300, 700])
def test_symmetric_norm(neurons):
    matrix = np.random.default_rng(0).normal(size=(neurons, neurons))
    symmetric = np.tril(matrix) + np.tril(matrix, -1).T
    expected = np.linalg.norm(symmetric, 1)
    # The upper triangle must not matter.
    assert _symmetric_norm(np.asfortranarray(matrix)) == pytest.approx(expected, rel=1e-13)


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
    bad_moments = Moments(
        moments.count, moments.mean_state, moments.mean_target, bad_gram, moments.cross
    )
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


def test_singular_matrix_raises():
    moments = Moments(5, np.zeros(2), np.zeros(1), np.zeros((2, 2), order="F"), np.ones((2, 1)))
    with pytest.raises(np.linalg.LinAlgError, match="singular"):
        solve_ridge(moments, 0.0)
