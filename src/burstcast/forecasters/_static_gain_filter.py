"""Corrections with a gain that does not change: what a small ensemble leaves of an observation.

An ensemble with fewer members than there are directions of error cannot correct all of them. A
static gain, made of the covariance of the states over a long time, corrects the mean for what the
ensemble has left of the innovation (the hybrid gain of Penny, "The hybrid local ensemble transform
Kalman filter", Monthly Weather Review 142, 2014).
"""

import numpy as np

from burstcast.base.arrays import FloatArray


def static_gain(
    covariance: FloatArray, matrix: FloatArray, noise: FloatArray, share: float
) -> FloatArray:
    """Gain of the Kalman filter for a fixed covariance of the error, ``(dimension, observed)``.

    ``covariance``: Covariance of the states over a long time, ``(dimension, dimension)``.
    ``matrix``: Matrix of the observation, ``(observed, dimension)``. ``noise``: Standard deviation
    of the errors of the observation, ``(observed,)``; above 0. ``share``: Covariance of the error,
    as a share of that of the states.
    """
    across = share * covariance @ matrix.T
    gain: FloatArray = np.linalg.solve(matrix @ across + np.diag(np.square(noise)), across.T).T
    return gain


def leading_directions(covariance: FloatArray, count: int) -> FloatArray:
    """Directions in which errors are largest, each as long as its standard deviation.

    ``covariance``: Covariance of the errors, ``(dimension, dimension)``. Shape ``(dimension,
    count)``; the largest entry of each is positive.
    """
    variances, eigenvectors = np.linalg.eigh(covariance)
    leading = eigenvectors[:, ::-1][:, :count]
    largest = np.argmax(np.abs(leading), axis=0)
    signs = np.sign(leading[largest, np.arange(leading.shape[1])])
    scale = np.sqrt(np.maximum(variances[::-1][:count], 0.0))
    directions: FloatArray = leading * signs * scale
    return directions
