"""Reservoirs and networks; the same network in other software."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.networks.dynamics import Dynamics
from burstcast.networks.network import EchoStateNetwork
from burstcast.networks.readout import MomentsAccumulator, solve_ridge
from burstcast.networks.reservoir import (
    ReservoirSeed,
    _bernoulli_positions,
    make_reservoir,
    spectral_radius,
)
from burstcast.networks.training import TrainingSeries, train


@pytest.mark.parametrize(("neurons", "connectivity"), [(60, 3), (200, 20), (201, 20), (400, 20)])
def test_recurrent_weights_have_spectral_radius_one(neurons, connectivity):
    for seed in range(2):
        generator = np.random.default_rng(seed)
        reservoir = make_reservoir(neurons, 9, connectivity, 0.1, generator)
        eigenvalues = np.linalg.eigvals(reservoir.recurrent.toarray())
        assert np.abs(eigenvalues).max() == pytest.approx(1, rel=1e-11)


def test_the_spectral_radius_of_known_matrices_depends_on_no_global_random_state():
    # A rotation scaled by 1.5 has a complex pair of that modulus; the rest is smaller.
    matrix = scipy.sparse.lil_array((300, 300))
    matrix.setdiag(np.linspace(-1.2, 1.2, 300))
    matrix[:2, :2] = 1.5 * np.array([[0.6, -0.8], [0.8, 0.6]])
    assert spectral_radius(scipy.sparse.csr_array(matrix)) == pytest.approx(1.5, rel=1e-12)
    # A negative eigenvalue counts by its modulus, small matrices are solved densely.
    small = scipy.sparse.csr_array(np.diag([0.5, -3.0, 1.0]))
    assert spectral_radius(small) == pytest.approx(3.0)
    matrix = make_reservoir(400, 3, 20, 0.1, np.random.default_rng(0)).recurrent
    np.random.seed(1)  # noqa: NPY002 - the state that must not matter
    first = spectral_radius(matrix)
    np.random.seed(2)  # noqa: NPY002
    assert spectral_radius(matrix) == first


def test_a_seed_makes_one_reservoir_and_every_neuron_may_be_connected_with_all_others():
    seed = ReservoirSeed(random_seed=2022, neurons=250, seed=5, connectivity=20, input_bias=0.1)
    first, again = seed.reservoir(9), seed.reservoir(9)
    assert (first.neurons, first.dimension, first.input_bias) == (250, 9, 0.1)
    assert (first.input_column == again.input_column).all()
    assert (first.input_weight == again.input_weight).all()
    assert (first.recurrent != again.recurrent).nnz == 0
    for change in ({"seed": 6}, {"random_seed": 1}):
        other = replace(seed, **change).reservoir(9)
        assert (first.recurrent != other.recurrent).nnz > 0
        assert (first.input_weight != other.input_weight).any()
        assert (first.input_column != other.input_column).any()
    reservoir = make_reservoir(5, 2, 4, 0.1, np.random.default_rng(0))
    # each weight is drawn with the probability d / (neurons - 1), which is one
    assert reservoir.recurrent.nnz == 5 * 5


def test_distribution_of_the_weights():
    neurons, dimension, connectivity = 1500, 9, 20
    reservoir = make_reservoir(neurons, dimension, connectivity, 0.1, np.random.default_rng(1))
    recurrent, weight = reservoir.recurrent, reservoir.input_weight
    count, probability = recurrent.nnz, connectivity / (neurons - 1)
    assert abs(count - neurons**2 * probability) < 5 * np.sqrt(neurons**2 * probability)
    # Row and column sums of a Bernoulli matrix have the variance N p (1 - p).
    of_columns = np.bincount(recurrent.indices, minlength=neurons)
    for length in (np.diff(recurrent.indptr), of_columns):
        assert length.var() == pytest.approx(neurons * probability * (1 - probability), rel=0.2)
    # The diagonal is an entry like the others.
    assert 0 < np.count_nonzero(recurrent.diagonal()) < 3 * connectivity
    # Uniform in [-1, 1] before the division by the spectral radius, which is near sqrt(d / 3).
    largest = np.abs(recurrent.data).max()
    scaled = recurrent.data / largest
    assert abs(scaled.mean()) < 5 / np.sqrt(3 * count)
    assert (scaled**2).mean() == pytest.approx(1 / 3, rel=0.03)
    assert 1 / largest == pytest.approx(np.sqrt(20 / 3), rel=0.1)
    share = np.bincount(reservoir.input_column, minlength=dimension + 1) / neurons
    assert len(share) == dimension + 1
    assert (np.abs(share - 0.1) < 5 * np.sqrt(0.09 / neurons)).all()
    assert weight.min() < -0.99
    assert 0.99 < weight.max() <= np.abs(weight).max() <= 1


@given(count=st.integers(1, 3000), probability=st.floats(1e-3, 1.0), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=50)
def test_positions_are_distinct_and_inside(count, probability, seed):
    position = _bernoulli_positions(count, probability, np.random.default_rng(seed))
    assert (np.diff(position) > 0).all()
    assert position.size == 0 or (position[0] >= 0 and position[-1] < count)
    if probability == 1.0:
        assert position.size == count


@pytest.mark.parametrize(
    ("neurons", "dimension", "connectivity", "bias", "reason"),
    [
        (1, 3, 1, 0.1, "too small"),
        (50, 0, 5, 0.1, "too small"),
        (50, 3, 0, 0.1, "connectivity"),
        (50, 3, 50, 0.1, "connectivity"),
        (50, 3, 5, np.nan, "bias"),
        (50, 3, 1e-6, 0.1, "spectral radius"),
    ],
)
def test_impossible_reservoirs_raise(neurons, dimension, connectivity, bias, reason):
    with pytest.raises(ValueError, match=reason):
        make_reservoir(neurons, dimension, connectivity, bias, np.random.default_rng(0))


# -- trained networks ------------------------------------------------------------------------------

WASHOUT = 100


@pytest.fixture(scope="module")
def network(reservoir, signal):
    input_range = np.ptp(signal, axis=(0, 2))
    dynamics = Dynamics(reservoir, 0.4, 0.5)
    training = TrainingSeries(signal[:-100].transpose(2, 0, 1), input_range)
    readout = train(dynamics, training, washout=WASHOUT, tikhonov=1e-6)
    return EchoStateNetwork(dynamics, readout, input_range)


def test_washout_and_forecast_scale_by_the_range(network, signal):
    states = network.washout(signal[:30])
    expected = network.dynamics.open_loop(signal[:30] / network.input_range[:, None])
    np.testing.assert_array_equal(states, expected)
    outputs, later = network.forecast(states, 2)
    first = network.readout.weights[:-1].T @ states + network.readout.weights[-1][:, None]
    np.testing.assert_allclose(outputs[0], first, atol=1e-10)
    # The first prediction, fed back as data, gives the second one.
    fed = network.washout(outputs[:1], states)
    second, _ = network.forecast(fed, 1)
    np.testing.assert_allclose(outputs[1], second[0], atol=1e-10)
    np.testing.assert_allclose(network.washout(outputs[1:], fed), later, atol=1e-10)


def test_an_offset_is_the_same_network_of_centred_data(network, signal):
    offset = np.array([100.0, -3.0, 0.5, 1e4])[: signal.shape[1]]
    moved = signal + offset[:, None]
    training = TrainingSeries(
        moved[:-100].transpose(2, 0, 1), network.input_range, input_offset=offset
    )
    assert training.part(slice(1)).input_offset is offset
    readout = train(network.dynamics, training, washout=WASHOUT, tikhonov=1e-6)
    centred = EchoStateNetwork(network.dynamics, readout, network.input_range, offset)
    expected, _ = network.forecast(network.washout(signal[:30]), 5)
    outputs, _ = centred.forecast(centred.washout(moved[:30]), 5)
    np.testing.assert_allclose(outputs, expected + offset[:, None], rtol=0, atol=1e-6)
    # with the bits of the same readout
    same = replace(network, input_offset=offset)
    states = network.washout(signal[:30])
    np.testing.assert_array_equal(same.forecast(states, 5)[0], expected + offset[:, None])


# -- ReservoirPy and scikit-learn ------------------------------------------------------------------


def reservoirpy_reservoir(dynamics, reservoirpy_nodes):
    reservoir = dynamics.reservoir
    columns = np.zeros((reservoir.neurons, reservoir.dimension + 1))
    columns[np.arange(reservoir.neurons), reservoir.input_column] = reservoir.input_weight
    columns *= dynamics.input_scaling
    return reservoirpy_nodes.Reservoir(
        W=dynamics.spectral_radius * reservoir.recurrent.toarray(),
        **{"Win": columns[:, :-1], "bias": reservoir.input_bias * columns[:, -1]},
        **{"lr": dynamics.leak_rate, "activation": "tanh"},
    )


def squared(states):
    """States with every second neuron squared, as ReservoirPy's users do it (a node of theirs)."""
    odd = np.arange(states.shape[-1]) % 2 == 1
    return np.where(odd, states**2, states)


@pytest.mark.parametrize("backend", ["compiled", "scipy"])
@pytest.mark.parametrize("kind", [(1.0, "linear"), (0.5, "linear"), (0.8, "quadratic")])
def test_reservoirpy_gives_the_same_states_and_forecast(reservoir, signal, backend, kind):
    reservoirpy_nodes = pytest.importorskip("reservoirpy.nodes")
    dynamics = Dynamics(reservoir, 0.6, 0.7, backend, *kind)
    seen = squared if kind[1] == "quadratic" else np.asarray
    input_range, series = np.ptp(signal, axis=(0, 2)), signal[:300, :, 0]
    scaled = series / input_range
    node = reservoirpy_reservoir(dynamics, reservoirpy_nodes)
    expected = node.run(scaled)
    panels = dynamics.state_panels(scaled[:, :, None], columns_per_panel=128)
    states = np.concatenate([panel.columns for panel in panels], axis=1)
    np.testing.assert_allclose(states.T, expected, rtol=0, atol=1e-13)
    accumulator = MomentsAccumulator(reservoir.neurons, reservoir.dimension)
    accumulator.add(dynamics.features(states[:, 50:-1]), series[51:].T)
    weights = solve_ridge(accumulator.moments(), 1e-4).weights
    node_readout = reservoirpy_nodes.Ridge(Wout=weights[:-1], bias=weights[-1])
    outputs, _ = dynamics.closed_loop(weights, input_range, states[:, -1:], 20)
    state = expected[-1]
    for output in outputs[:, :, 0]:
        predicted = node_readout(seen(state))
        np.testing.assert_allclose(output, predicted, rtol=0, atol=1e-9)
        state = node(predicted / input_range)
