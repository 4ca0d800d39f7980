"""Filters that take the noise for white, where it is correlated in time.

Forecasters receive the true washouts of a case and add noise of the variance that the filter
assumes: a first-order autoregressive process, with a correlation time in samples. The noise of the
training series, from which the variance is estimated, is white.
"""

import hashlib
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from burstcast.base import random_streams
from burstcast.data.dataset import add_observation_noise, component_scales
from burstcast.forecasters.equations_filtered import FilteredEquations
from burstcast.forecasters.quadratic_filtered import FilteredQuadraticModel


def coloured_noise(true_washout, correlation_samples):
    """Noise of unit variance for washouts ``(steps, dimension, batch)``; equal ones have equal."""
    noise = np.empty_like(true_washout)
    for column in range(true_washout.shape[2]):
        name = hashlib.sha256(np.ascontiguousarray(true_washout[..., column])).hexdigest()
        generator = random_streams.stream(2022, "coloured_noise", name)
        noise[..., column] = generator.standard_normal(true_washout.shape[:2])
    if not correlation_samples:
        return noise
    factor = np.exp(-1 / correlation_samples)
    noise[1:] *= np.sqrt(1 - factor**2)
    return lfilter([1.0], [1.0, -factor], noise, axis=0)


NOISE = 0.01
"""Standard deviation of the noise, in standard deviations of each component."""


@dataclass(frozen=True)
class _InColouredNoise:
    """A filtered forecaster whose observations have coloured noise."""

    sees_truth = True

    correlation_samples: float = 0.0  #: time in which the correlation falls to 1/e; 0: white

    def fit(self, training, case):
        """Fit to true series with white noise."""
        scales = component_scales(training)
        noisy = add_observation_noise(training, 0, NOISE, scales, 2022, "coloured_noise", "white")
        return super().fit(noisy, case)

    def ensemble(self, washout):
        """Memories of the filter's members after a washout with noise."""
        noise = coloured_noise(washout, self.correlation_samples)
        return super().ensemble(washout + self.errors[:, np.newaxis] * noise)


@dataclass(frozen=True)
class EquationsInColouredNoise(_InColouredNoise, FilteredEquations):
    """The true equations with a filter."""


@dataclass(frozen=True)
class LearntEquationsInColouredNoise(_InColouredNoise, FilteredQuadraticModel):
    """Equations learnt from series with white noise, with a filter."""
