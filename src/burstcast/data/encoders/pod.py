"""Proper orthogonal decomposition: the modes that hold most of the variance.

Source: Holmes, Lumley, Berkooz and Rowley, "Turbulence, Coherent Structures, Dynamical Systems and
Symmetry" (2012). Snapshots are taken together with their images under all symmetries of the
system, as if infinitely many data were there. Modes of much energy need not carry the event: the
dissipation of a few leading modes of a turbulent flow can be anticorrelated with the true one, so
that the observable should be a channel of its own.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.data.encoders._moments import state_moments
from burstcast.data.encoders.base import Encoder, EncodingCase


@dataclass(frozen=True)
class PodEncoder(Encoder):
    """Coefficients of the leading modes.

    Options are ``modes``, how many modes are kept, or ``variance``, the share of the variance that
    the kept modes have at least; and ``symmetrised``, whether images of the snapshots under the
    symmetries of the system count (true by default).
    """

    decodes: ClassVar[bool] = True
    option_names: ClassVar[tuple[str, ...]] = ("modes", "variance", "symmetrised")
    array_names: ClassVar[tuple[str, ...]] = ("mean", "modes", "variances")

    mean: FloatArray  #: mean of the snapshots, ``(component,)``
    #: orthonormal modes, ``(component, mode)``; the largest entry of each is positive
    modes: FloatArray
    variances: FloatArray  #: variance of the coefficient of each mode, kept or not, falling

    @classmethod
    def fit(cls, training: FloatArray, case: EncodingCase) -> Self:
        """Diagonalise the covariance of the training snapshots (see `Encoder.fit`)."""
        snapshots = training.reshape(-1, training.shape[-1])
        symmetric = case.options.get("symmetrised", True) and case.observation is None
        moments = state_moments(snapshots, case.space if symmetric else None)
        variances, modes = np.linalg.eigh(moments.covariance)
        variances, modes = np.maximum(variances[::-1], 0.0), modes[:, ::-1]
        count = _count(case.options, variances, len(snapshots))
        kept = modes[:, :count]
        largest = np.argmax(np.abs(kept), axis=0)
        signs = np.sign(kept[largest, np.arange(count)])
        return cls(moments.mean, np.ascontiguousarray(kept * signs), variances)

    @classmethod
    def channel_names(cls, case: EncodingCase) -> tuple[str, ...]:
        """Names by number: "mode_1" has the most variance."""
        count, most = case.options.get("modes"), len(case.components)
        if count is None or not 1 <= count <= most:
            raise ValueError(f"modes must be a number from 1 to {most}, the components of a state")
        return tuple(f"mode_{number}" for number in range(1, int(count) + 1))

    def encode(self, observed: FloatArray) -> FloatArray:
        """Coefficients ``(mode, ...)`` of states ``(component, ...)``."""
        return np.tensordot(self.modes.T, (observed.T - self.mean).T, axes=1)

    def decode(self, channels: FloatArray) -> FloatArray:
        """States ``(component, ...)`` of coefficients ``(mode, ...)``."""
        return (np.tensordot(self.modes, channels, axes=1).T + self.mean).T


def _count(options: Mapping[str, float], variances: FloatArray, snapshots: int) -> int:
    """Number of modes that the options ask for."""
    if ("modes" in options) == ("variance" in options):
        raise ValueError("a POD takes either modes or variance, the share that they shall hold")
    if "variance" in options:
        share = float(options["variance"])
        if not 0.0 < share <= 1.0:
            raise ValueError(f"variance must be above 0 and at most 1, not {share:g}")
        held = np.cumsum(variances) / variances.sum()
        return min(int(np.searchsorted(held, share)) + 1, len(variances))
    count, most = int(options["modes"]), min(len(variances), snapshots)
    if not 1 <= count <= most:
        raise ValueError(
            f"modes is {count}; {snapshots} snapshots of {len(variances)} components have 1 to "
            f"{most} modes"
        )
    return count
