"""Training of the readout: moments of states and targets, and ridge regression from them.

The paper's ridge regression minimises sum_m |W_out^T [r_m; 1] - y_m|^2 + beta |W_out|^2 over all
the training steps m: beta is added to the plain sum, and the output bias is regularised like the
other rows. With M rows, the means r and y of states and targets, the centred moments G and C and
kappa = M beta / (M + beta), the same minimum solves

    (G + beta I + kappa r r^T) w = C + kappa r y^T,     bias = M (y - r^T w) / (M + beta).

This is an identity, not an approximation, but rounding treats it better: at beta = 1e-12 the
regularisation lies below the rounding error of the plain Gram matrix, whose Cholesky factorisation
then fails for some networks, while the centred one loses fewer digits.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy

from burstcast.base.arrays import FloatArray

ReadoutKind = Literal["linear", "quadratic"]
"""What the output weights multiply: the states, or the states with every second one squared."""


def readout_features(
    states: FloatArray, readout: ReadoutKind, *, overwrite: bool = False
) -> FloatArray:
    """States ``(neurons, ...)`` as the output weights multiply them, ``(neurons, ...)``.

    ``overwrite``: Whether the states may be overwritten.

    A quadratic readout sees the squares of the neurons 1, 3, 5, ..., which breaks the symmetry of
    the hyperbolic tangent: Lu et al., Chaos 27 (2017) 041102; Pathak et al., Physical Review
    Letters 120 (2018) 024102.
    """
    if readout == "linear":
        return states
    features = states if overwrite else states.copy()
    features[1::2] *= features[1::2]
    return features


@dataclass(frozen=True)
class Moments:
    """First and centred second moments of reservoir states and targets."""

    count: int  #: number of rows (training steps), M
    #: mean_state, mean_target: shapes ``(neurons,)`` and ``(dimension,)``
    mean_state: FloatArray
    mean_target: FloatArray
    #: sum of the products of centred states, ``(neurons, neurons)``, Fortran order; only the lower
    #: triangle is meaningful
    gram: FloatArray
    #: sum of the products of centred states with centred targets, ``(neurons, dimension)``
    cross: FloatArray

    def merge(self, other: "Moments") -> "Moments":
        """Moments of the rows of both; exact, up to rounding."""
        if self.cross.shape != other.cross.shape:
            raise ValueError(
                f"moments of shapes {self.cross.shape} and {other.cross.shape} do not merge"
            )
        count = self.count + other.count
        share = other.count / count
        state_shift = other.mean_state - self.mean_state
        target_shift = other.mean_target - self.mean_target
        factor = self.count * share
        gram = _with_outer(self.gram + other.gram, factor, state_shift)
        cross = self.cross + other.cross + factor * np.outer(state_shift, target_shift)
        return Moments(
            count,
            self.mean_state + share * state_shift,
            self.mean_target + share * target_shift,
            gram,
            cross,
        )


class MomentsAccumulator:
    """Accumulates moments panel by panel, in one Gram matrix.

    The first panel's mean is subtracted from all rows; `moments` corrects the rest by rank one.
    """

    def __init__(self, neurons: int, dimension: int) -> None:
        self._count = 0
        self._state_shift = np.zeros(neurons)
        self._target_shift = np.zeros(dimension)
        self._state_sum = np.zeros(neurons)
        self._target_sum = np.zeros(dimension)
        self._gram = np.zeros((neurons, neurons), order="F")
        self._cross = np.zeros((neurons, dimension))

    def add(self, states: FloatArray, targets: FloatArray, *, overwrite: bool = False) -> None:
        """Add a panel: states ``(neurons, columns)``, targets ``(dimension, columns)``.

        ``overwrite``: Whether the states may be overwritten.
        """
        neurons, dimension = self._cross.shape
        columns = states.shape[1]
        if states.shape != (neurons, columns) or targets.shape != (dimension, columns):
            raise ValueError(
                f"states {states.shape} and targets {targets.shape} do not fit a readout of "
                f"{neurons} neurons and {dimension} outputs"
            )
        if columns == 0:
            return
        # One non-finite value makes the sum of its row non-finite.
        state_mean, target_mean = states.mean(axis=1), targets.mean(axis=1)
        if not (np.isfinite(state_mean).all() and np.isfinite(target_mean).all()):
            raise ValueError("the states or targets of the training are not finite")
        if self._count == 0:
            self._state_shift, self._target_shift = state_mean, target_mean
        shift, into = self._state_shift[:, np.newaxis], states if overwrite else None
        shifted_states = np.subtract(states, shift, out=into)
        shifted_targets = targets - self._target_shift[:, np.newaxis]
        self._count += columns
        self._state_sum += columns * (state_mean - self._state_shift)
        self._target_sum += columns * (target_mean - self._target_shift)
        # in this order BLAS goes through the states row by row: up to twice as fast
        self._cross += (shifted_targets @ shifted_states.T).T
        # The transpose of the panel is column-major: BLAS takes it without a copy.
        self._gram = scipy.linalg.blas.dsyrk(
            1.0, shifted_states.T, beta=1.0, c=self._gram, trans=1, lower=1, overwrite_c=1
        )

    def moments(self) -> Moments:
        """Moments of the rows so far; a copy, so that more rows may follow."""
        if self._count == 0:
            raise ValueError("no training data: the moments have no rows")
        state_offset = self._state_sum / self._count
        target_offset = self._target_sum / self._count
        gram = _with_outer(self._gram.copy(order="F"), -float(self._count), state_offset)
        cross = self._cross - self._count * np.outer(state_offset, target_offset)
        return Moments(
            self._count,
            self._state_shift + state_offset,
            self._target_shift + target_offset,
            gram,
            cross,
        )


@dataclass(frozen=True)
class Readout:
    """A trained readout, and how it was solved for."""

    #: W_out, shape ``(neurons + 1, dimension)``; the last row is the output bias
    weights: FloatArray
    tikhonov: float  #: the regularisation beta it was trained with
    solver: str  #: how the linear system was solved: "cholesky" or "ldl"
    #: estimate of the reciprocal condition number of the regularised matrix in the 1-norm, to three
    #: digits
    reciprocal_condition: float


def solve_ridge(moments: Moments, tikhonov: float) -> Readout:
    """Ridge regression of the targets on the states (see the module).

    By Cholesky's factorisation; where rounding has made the matrix indefinite, by LDL^T with
    Bunch-Kaufman pivoting. ``tikhonov``: beta, added to the plain sum over the training steps.
    """
    if not (tikhonov >= 0 and np.isfinite(tikhonov)):
        raise ValueError(f"the Tikhonov parameter must be finite and not negative: {tikhonov}")
    count, mean_state, mean_target = moments.count, moments.mean_state, moments.mean_target
    kappa = count * tikhonov / (count + tikhonov)
    matrix = _system_matrix(moments, tikhonov, kappa)
    right_hand_side = moments.cross + kappa * np.outer(mean_state, mean_target)
    # A non-finite entry of the lower triangle makes the norm non-finite.
    norm = _symmetric_norm(matrix)
    if not (np.isfinite(norm) and np.isfinite(right_hand_side).all()):
        raise ValueError("the moments of the training data are not finite")

    lapack = scipy.linalg.lapack  # loaded here: most of what imports this module solves nothing
    factor, info = lapack.dpotrf(matrix, lower=1, clean=0, overwrite_a=1)
    if info == 0:
        solver = "cholesky"
        weights, _ = lapack.dpotrs(factor, right_hand_side, lower=1)
        reciprocal_condition, _ = lapack.dpocon(factor, norm, uplo="L")
    else:
        # The failed factorisation has overwritten the matrix.
        matrix = _system_matrix(moments, tikhonov, kappa)
        work_size = int(lapack.dsytrf_lwork(matrix.shape[0], lower=1)[0])
        solver = "ldl"
        factor, pivots, info = lapack.dsytrf(matrix, lower=1, lwork=work_size, overwrite_a=1)
        if info != 0:
            raise np.linalg.LinAlgError(
                f"the matrix of the ridge regression is singular at beta = {tikhonov}"
            )
        weights, _ = lapack.dsytrs(factor, pivots, right_hand_side, lower=1)
        reciprocal_condition, _ = lapack.dsycon(factor, pivots, norm, lower=1)
    bias = count * (mean_target - mean_state @ weights) / (count + tikhonov)
    weights = np.vstack([weights, bias])
    if not np.isfinite(weights).all():
        raise np.linalg.LinAlgError(f"the readout weights are not finite at beta = {tikhonov}")
    # an estimate, whose last bits depend on where LAPACK's working memory happens to lie, unlike
    # the weights: without rounding, the same network would be another file each time
    return Readout(weights, float(tikhonov), solver, float(f"{reciprocal_condition:.3g}"))


def _system_matrix(moments: Moments, tikhonov: float, kappa: float) -> FloatArray:
    """Lower triangle of G + beta I + kappa r r^T, a fresh array in Fortran order."""
    matrix = moments.gram.copy(order="F")
    np.einsum("ii->i", matrix)[:] += tikhonov
    return _with_outer(matrix, kappa, moments.mean_state)


def _with_outer(matrix: FloatArray, factor: float, vector: FloatArray) -> FloatArray:
    """``matrix + factor * outer(vector, vector)``, lower triangle, in the memory of the matrix."""
    return np.asarray(scipy.linalg.blas.dsyr(factor, vector, a=matrix, lower=1, overwrite_a=1))


def _symmetric_norm(lower: FloatArray, rows_per_block: int = 256) -> float:
    """1-norm of a symmetric matrix given by its lower triangle, without a copy of the whole."""
    neurons = lower.shape[0]
    sums = np.zeros(neurons)
    for start in range(0, neurons, rows_per_block):
        columns = slice(start, min(start + rows_per_block, neurons))
        block = np.abs(lower[start:, columns], order="C")
        square = block[: block.shape[1]]
        # entries of the diagonal count once: in the rows
        square[...], diagonal = np.tril(square, -1), square.diagonal().copy()
        sums[columns] += block.sum(axis=0)
        np.fill_diagonal(square, diagonal)
        sums[start:] += block.sum(axis=1)
    return float(sums.max())
