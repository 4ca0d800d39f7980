"""Velocity statistics of the flow, from the moments of its modes' amplitudes.

Averages over time of velocities and of products of two of them follow from the means of a_i and of
a_i a_j alone. Source: section "Statistical prediction of extreme events" of the paper.
"""

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.systems.mfe_modes import ProfileMatrices, flow_modes
from burstcast.systems.state_space import StateSpace


def equally_spaced_profiles(system: StateSpace, points: int) -> ProfileMatrices | None:
    """Profiles at ``points`` heights from wall to wall; None for a system without modes."""
    modes = flow_modes(system)
    return None if modes is None else modes.profile_matrices(np.linspace(-1.0, 1.0, points))


def normalised_root_mean_square_error(reference: FloatArray, candidate: FloatArray) -> float:
    """Root mean square error in units of the range of the reference (paper, NRMSE)."""
    if reference.shape != candidate.shape:
        raise ValueError(f"{reference.shape} and {candidate.shape} values cannot be compared")
    reference_range = reference.max() - reference.min()
    if not reference_range > 0:
        raise ValueError("an error cannot be normalised by the range of a constant reference")
    return float(np.sqrt(np.mean(np.square(candidate - reference))) / reference_range)
