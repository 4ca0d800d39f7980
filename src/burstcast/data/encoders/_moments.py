"""Moments of states, averaged over the symmetries of their system, and the best linear estimate."""

from typing import NamedTuple

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.state_space import StateSpace


class StateMoments(NamedTuple):
    """First and second moments of states."""

    mean: FloatArray
    covariance: FloatArray  #: ``(dimension, dimension)``


def kalman_gain(covariance: FloatArray, matrix: FloatArray, noise: FloatArray) -> FloatArray:
    """Gain C H' (H C H' + R)^-1 of the best linear estimate, ``(dimension, observed)``.

    ``covariance``: C, of the states or of the error of an earlier estimate. ``matrix``: H, of the
    observation, ``(observed, dimension)``. ``noise``: Standard deviation of its errors,
    ``(observed,)``.
    """
    across = covariance @ matrix.T
    gain: FloatArray = np.linalg.solve(matrix @ across + np.diag(np.square(noise)), across.T).T
    return gain


def state_moments(states: FloatArray, space: StateSpace | None = None) -> StateMoments:
    """Moments of snapshots, and of their images under all symmetries of their system.

    The images themselves are never computed: moments are averaged over the powers of one symmetry
    after the other.

    ``states``: ``(snapshots, dimension)``. ``space``: Space of the states; None, or a space without
    symmetries: moments of the snapshots alone.
    """
    mean = states.mean(axis=0)
    second = states.T @ states / len(states)
    for symmetry in space.symmetries() if isinstance(space, DynamicalSystem) else ():
        matrix = symmetry.transform(np.eye(len(mean)))
        means, seconds = [mean], [second]
        for _ in range(symmetry.order - 1):
            means.append(matrix @ means[-1])
            seconds.append(matrix @ seconds[-1] @ matrix.T)
        mean, second = np.mean(means, axis=0), np.mean(seconds, axis=0)
    return StateMoments(mean, second - np.outer(mean, mean))
