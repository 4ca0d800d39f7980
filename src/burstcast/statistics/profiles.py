"""Velocity statistics of the flow, from the moments of its modes' amplitudes.

Averages over time of velocities and of products of two of them follow from the means of a_i and of
a_i a_j alone. Source: section "Statistical prediction of extreme events" of the paper.
"""

from dataclasses import dataclass

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.statistics.moments import StateMoments
from burstcast.systems.mfe_modes import MoehlisFaisstEckhardtModes, ProfileMatrices, flow_modes
from burstcast.systems.state_space import StateSpace


@dataclass(frozen=True)
class Profiles:
    """Averages over x, z and time against the height y, ``(heights,)`` each."""

    #: u, uu, uv: profiles of the streamwise velocity, its square, and the Reynolds stress
    u: FloatArray
    uu: FloatArray
    uv: FloatArray


def equally_spaced_profiles(system: StateSpace, points: int) -> ProfileMatrices | None:
    """Profiles at ``points`` heights from wall to wall; None for a system without modes."""
    modes = flow_modes(system)
    return None if modes is None else modes.profile_matrices(np.linspace(-1.0, 1.0, points))


def velocity_profiles(matrices: ProfileMatrices, moments: StateMoments) -> Profiles:
    """Velocity profiles of a flow with these moments, by matrices of its modes."""
    u, uu, uv = matrices.profiles(moments.mean, moments.mean_product)
    return Profiles(u, uu, uv)


def midplane_mean_square(
    modes: MoehlisFaisstEckhardtModes, moments: StateMoments, x: FloatArray, z: FloatArray
) -> FloatArray:
    """Time average of u^2 in the midplane y = 0, ``(points in x, points in z)``."""
    return modes.midplane_mean_square(moments.mean_product, x, z)


def normalised_root_mean_square_error(reference: FloatArray, candidate: FloatArray) -> float:
    """Root mean square error in units of the range of the reference (paper, NRMSE)."""
    if reference.shape != candidate.shape:
        raise ValueError(f"{reference.shape} and {candidate.shape} values cannot be compared")
    reference_range = reference.max() - reference.min()
    if not reference_range > 0:
        raise ValueError("an error cannot be normalised by the range of a constant reference")
    return float(np.sqrt(np.mean(np.square(candidate - reference))) / reference_range)
