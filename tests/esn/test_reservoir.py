import numpy as np
import pytest
import scipy.sparse
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.esn.reservoir import _bernoulli_positions, make_reservoir, spectral_radius


def dense_radius(matrix):
    return np.abs(np.linalg.eigvals(matrix.toarray())).max()


@pytest.mark.parametrize(("neurons", "connectivity"), [(60, 3), (200, 20), (201, 20), (400, 20)])
def test_recurrent_weights_have_spectral_radius_one(neurons, connectivity):
    for seed in range(2):
        generator = np.random.default_rng(seed)
        reservoir = make_reservoir(neurons, 9, connectivity, 0.1, generator)
        assert dense_radius(reservoir.recurrent) == pytest.approx(1, rel=1e-11)


def test_every_neuron_may_be_connected_with_all_others():
    reservoir = make_reservoir(5, 2, 4, 0.1, np.random.default_rng(0))
    # each weight is drawn with the probability d / (neurons - 1), which is one
    assert reservoir.recurrent.nnz == 5 * 5


def test_spectral_radius_of_known_matrices():
    # A rotation scaled by 1.5 has a complex pair of that modulus; the rest is smaller.
    matrix = scipy.sparse.lil_array((300, 300))
    matrix.setdiag(np.linspace(-1.2, 1.2, 300))
    matrix[:2, :2] = 1.5 * np.array([[0.6, -0.8], [0.8, 0.6]])
    assert spectral_radius(scipy.sparse.csr_array(matrix)) == pytest.approx(1.5, rel=1e-12)
    # A negative eigenvalue counts by its modulus, small matrices are solved densely.
    small = scipy.sparse.csr_array(np.diag([0.5, -3.0, 1.0]))
    assert spectral_radius(small) == pytest.approx(3.0)


def test_spectral_radius_does_not_depend_on_global_random_state():
    matrix = make_reservoir(400, 3, 20, 0.1, np.random.default_rng(0)).recurrent
    np.random.seed(1)  # noqa: NPY002 - the state that must not matter
    first = spectral_radius(matrix)
    np.random.seed(2)  # noqa: NPY002
    assert spectral_radius(matrix) == first


def test_same_generator_same_reservoir():
    one, two = (make_reservoir(250, 9, 20, 0.1, np.random.default_rng(5)) for _ in range(2))
    assert (one.input_column == two.input_column).all()
    assert (one.input_weight == two.input_weight).all()
    assert (one.recurrent != two.recurrent).nnz == 0
    other = make_reservoir(250, 9, 20, 0.1, np.random.default_rng(6))
    assert (one.recurrent != other.recurrent).nnz > 0


def test_distribution_of_the_weights():
    neurons, dimension, connectivity = 1500, 9, 20
    reservoir = make_reservoir(neurons, dimension, connectivity, 0.1, np.random.default_rng(1))
    count = reservoir.recurrent.nnz
    probability = connectivity / (neurons - 1)
    expected = neurons**2 * probability
    assert abs(count - expected) < 5 * np.sqrt(expected)
    # Row and column sums of a Bernoulli matrix have the variance N p (1 - p).
    for length in (
        np.diff(reservoir.recurrent.indptr),
        np.bincount(reservoir.recurrent.indices, minlength=neurons),
    ):
        assert length.var() == pytest.approx(neurons * probability * (1 - probability), rel=0.2)
    # The diagonal is an entry like the others.
    assert 0 < np.count_nonzero(reservoir.recurrent.diagonal()) < 3 * connectivity
    # Uniform in [-1, 1] before the division by the spectral radius, which is near sqrt(d / 3).
    scaled = reservoir.recurrent.data / np.abs(reservoir.recurrent.data).max()
    assert abs(scaled.mean()) < 5 / np.sqrt(3 * count)
    assert (scaled**2).mean() == pytest.approx(1 / 3, rel=0.03)
    assert 1 / np.abs(reservoir.recurrent.data).max() == pytest.approx(np.sqrt(20 / 3), rel=0.1)
    assert set(reservoir.input_column) == set(range(dimension + 1))
    share = np.bincount(reservoir.input_column) / neurons
    assert (np.abs(share - 0.1) < 5 * np.sqrt(0.09 / neurons)).all()
    assert reservoir.input_weight.min() < -0.99
    assert reservoir.input_weight.max() > 0.99
    assert np.abs(reservoir.input_weight).max() <= 1


@given(
    count=st.integers(1, 3000),
    probability=st.floats(1e-3, 1.0),
    seed=st.integers(0, 2**32 - 1),
)
@settings(max_examples=50, deadline=None)
def test_positions_are_distinct_and_inside(count, probability, seed):
    position = _bernoulli_positions(count, probability, np.random.default_rng(seed))
    assert (np.diff(position) > 0).all()
    assert position.size == 0 or (position[0] >= 0 and position[-1] < count)
    if probability == 1.0:
        assert position.size == count


def test_every_position_is_equally_likely():
    generator = np.random.default_rng(0)
    hits = np.zeros(20)
    for _ in range(4000):
        hits[_bernoulli_positions(20, 0.3, generator)] += 1
    assert (np.abs(hits - 1200) < 5 * np.sqrt(4000 * 0.21)).all()


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
