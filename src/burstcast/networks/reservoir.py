"""Random matrices of an echo state network: the input weights and the recurrent weights.

The reservoir is drawn once per network realisation; the hyperparameters (spectral radius and input
scaling) multiply it later, in `burstcast.networks.dynamics`. See the section "Echo state networks"
of the paper.
"""

from dataclasses import dataclass

import numpy as np
import scipy

from burstcast.base import random_streams
from burstcast.base.arrays import FloatArray, Int32Array, IntArray

# Below this size the dense eigenvalues cost less than a tenth of a second.
_DENSE_NEURONS = 200
# One eigenvalue in a small Krylov space is often the wrong one (off by up to 2 % at N >= 2000):
# pairs of complex eigenvalues crowd at the edge of the spectrum of a random matrix.
_EIGENVALUES = 6
_KRYLOV_VECTORS = 60


@dataclass(frozen=True)
class Reservoir:
    """The random matrices W_in and W of one network, before any hyperparameter."""

    #: the one input that feeds each neuron, shape ``(neurons,)``. Columns 0 to ``dimension - 1``
    #: are the components of the input, column ``dimension`` is the bias.
    input_column: Int32Array
    input_weight: FloatArray  #: its weight, uniform in [-1, 1], shape ``(neurons,)``
    #: recurrent weights W, shape ``(neurons, neurons)``, of spectral radius one
    recurrent: "scipy.sparse.csr_array"
    dimension: int  #: number of components of the input, N_u
    input_bias: float  #: the constant b_in that is appended to every input

    @property
    def neurons(self) -> int:
        """Number of neurons, N_r."""
        return int(self.input_column.size)


@dataclass(frozen=True)
class ReservoirSeed:
    """Seed of a reservoir, common to all cases, strategies and hyperparameters."""

    random_seed: int  #: the one root of all random numbers
    neurons: int
    seed: int  #: which realisation of its size
    #: connectivity, input_bias: see `make_reservoir`
    connectivity: float
    input_bias: float

    def reservoir(self, dimension: int) -> Reservoir:
        """Make the reservoir for states of some dimension."""
        stream = random_streams.stream(self.random_seed, "reservoir", self.neurons, self.seed)
        return make_reservoir(self.neurons, dimension, self.connectivity, self.input_bias, stream)


def make_reservoir(
    neurons: int,
    dimension: int,
    connectivity: float,
    input_bias: float,
    generator: np.random.Generator,
) -> Reservoir:
    """Draw a reservoir.

    Each row of the ``dimension + 1`` columns of W_in has one non-zero entry at a random column,
    uniform in [-1, 1]. Each entry of W is non-zero with probability
    ``connectivity / (neurons - 1)`` independently, uniform in [-1, 1]; W is then divided by its
    spectral radius.

    Parameters
    ----------
    neurons
        Size of the reservoir, N_r; at least 2.
    dimension
        Number of components of the input, N_u.
    connectivity
        Mean number of connections of a neuron, d; positive and at most ``neurons - 1``.
    input_bias
        The constant b_in that is appended to every input.
    generator
        Source of the random numbers.

    Raises
    ------
    ValueError
        If an argument is out of bounds, or if W has no eigenvalue other than zero, so that it
        cannot be scaled (a very small or very sparse reservoir).

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.networks.reservoir import make_reservoir
    >>> reservoir = make_reservoir(300, 3, 20, 0.1, np.random.default_rng(0))
    >>> reservoir.neurons, reservoir.recurrent.shape
    (300, (300, 300))
    """
    if neurons < 2 or dimension < 1:
        raise ValueError(f"a reservoir of {neurons} neurons and {dimension} inputs is too small")
    if not 0 < connectivity <= neurons - 1:
        raise ValueError(
            f"connectivity must lie in (0, neurons - 1] = (0, {neurons - 1}], not {connectivity}"
        )
    if not np.isfinite(input_bias):
        raise ValueError(f"the input bias must be finite, not {input_bias}")
    input_column = generator.integers(0, dimension + 1, size=neurons, dtype=np.int32)
    input_weight = generator.uniform(-1.0, 1.0, size=neurons)
    position = _bernoulli_positions(neurons * neurons, connectivity / (neurons - 1), generator)
    weight = generator.uniform(-1.0, 1.0, size=position.size)
    row_start = np.searchsorted(position, np.arange(neurons + 1) * neurons)
    recurrent = scipy.sparse.csr_array(
        (weight, (position % neurons).astype(np.int32), row_start.astype(np.int32)),
        shape=(neurons, neurons),
    )
    radius = spectral_radius(recurrent)
    # A nilpotent matrix (no cycle in its graph) has radius zero up to rounding.
    if radius < 1e-6:
        raise ValueError(
            f"the spectral radius of this reservoir is zero and cannot be scaled: {neurons} "
            f"neurons with a connectivity of {connectivity} are too few or too sparse"
        )
    recurrent.data /= radius
    return Reservoir(input_column, input_weight, recurrent, dimension, float(input_bias))


def spectral_radius(matrix: "scipy.sparse.csr_array") -> float:
    """Largest absolute eigenvalue of a square sparse matrix.

    Of large matrices by Arnoldi iterations for the six largest eigenvalues, which agrees with dense
    eigenvalues to rounding for random matrices; by these where they do not converge.
    """
    neurons = matrix.shape[0]
    if neurons <= _DENSE_NEURONS:
        return _dense_spectral_radius(matrix)
    # A fixed start vector, so that the result does not depend on the state of any generator. A
    # constant one could be an eigenvector of a structured matrix.
    start = np.cos(np.arange(neurons, dtype=np.float64))
    try:
        eigenvalues = scipy.sparse.linalg.eigs(
            matrix,
            k=_EIGENVALUES,
            ncv=_KRYLOV_VECTORS,
            v0=start,
            return_eigenvectors=False,
        )
    except scipy.sparse.linalg.ArpackError:
        return _dense_spectral_radius(matrix)
    return float(np.abs(eigenvalues).max())


def _dense_spectral_radius(matrix: "scipy.sparse.csr_array") -> float:
    return float(np.abs(scipy.linalg.eigvals(matrix.toarray())).max())


def _bernoulli_positions(
    count: int, probability: float, generator: np.random.Generator
) -> IntArray:
    """Indices of the successes in ``count`` independent trials, by their geometric gaps."""
    expected = count * probability
    batch = int(expected + 6.0 * np.sqrt(expected)) + 16
    position = np.empty(0, dtype=np.int64)
    last = -1
    while last < count:
        drawn = last + np.cumsum(generator.geometric(probability, size=batch))
        position = np.concatenate([position, drawn])
        last = int(position[-1])
    return position[position < count]
