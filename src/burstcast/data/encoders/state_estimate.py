"""The best linear estimate of the state of a flow from the readings of sensors.

Source: linear stochastic estimation (Adrian, "Stochastic estimation of conditional structure",
1994), the Gauss-Markov estimate. Mean and covariance of the states are taken over the training
series with their images under the symmetries of the system.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.data.encoders._moments import StateMoments, kalman_gain, state_moments
from burstcast.data.encoders.base import Encoder, EncodingCase
from burstcast.data.observation.base import Observation
from burstcast.systems.state_space import component_names


@dataclass(frozen=True)
class StateEstimateEncoder(Encoder):
    """Estimates of all components of a state."""

    decodes: ClassVar[bool] = True
    array_names: ClassVar[tuple[str, ...]] = ("gain", "constant")

    observation: Observation  #: what instruments see of a state
    gain: FloatArray  #: ``(dimension, observed)``
    constant: FloatArray

    @classmethod
    def fit(cls, training: FloatArray, case: EncodingCase) -> Self:
        """Estimate from the moments of the true training states (see `Encoder.fit`)."""
        return cls.of(state_moments(training.reshape(-1, training.shape[-1]), case.space), case)

    @classmethod
    def restore(cls, arrays: Mapping[str, FloatArray], case: EncodingCase) -> Self:
        """Estimate of a case (see `Encoder.restore`)."""
        # the columns in one piece, as `of` has them: products have the same bits
        return cls(_observation(case), np.asfortranarray(arrays["gain"]), arrays["constant"])

    @classmethod
    def of(cls, moments: StateMoments, case: EncodingCase) -> Self:
        """Estimate from moments of the states.

        With mean m and covariance C of the states, observation matrix H and covariance R of its
        errors, the estimate from y is m + C H' (H C H' + R)^-1 (y - H m).
        """
        observation = _observation(case)
        matrix = observation.matrix
        noise = np.zeros(len(matrix)) if case.noise is None else case.noise
        if not (noise > 0.0).all():
            raise ValueError("an estimate of the state takes observations with noise, not without")
        gain = kalman_gain(moments.covariance, matrix, noise)
        constant = moments.mean - gain @ (matrix @ moments.mean)
        return cls(observation, gain, constant)

    @classmethod
    def channel_names(cls, case: EncodingCase) -> tuple[str, ...]:
        """Names of the components of a state."""
        _observation(case)
        return component_names(case.space)

    def encode(self, observed: FloatArray) -> FloatArray:
        """Estimates ``(dimension, ...)`` of states from what was observed, ``(observed, ...)``."""
        return (np.tensordot(self.gain, observed, axes=1).T + self.constant).T

    def decode(self, channels: FloatArray) -> FloatArray:
        """Sensor readings of states ``(dimension, ...)``."""
        return self.observation(channels)


def _observation(case: EncodingCase) -> Observation:
    """Observation of a case. Raises ValueError if states are observed themselves."""
    if case.observation is None:
        raise ValueError("the state is observed itself: there is nothing to estimate")
    return case.observation
