"""The state of a flow from what instruments see of it: the best linear estimate.

Source: linear stochastic estimation (Adrian, "Stochastic estimation of conditional structure",
1994), the Gauss-Markov estimate. Mean and covariance of the states are those of the training
series with their images under the symmetries of the system.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.encoders._moments import state_moments
from burstcast.encoders.base import Encoder, EncodingCase
from burstcast.systems.state_space import component_names


@dataclass(frozen=True)
class StateEstimateEncoder(Encoder):
    """Estimates of all components of a state.

    Attributes
    ----------
    gain
        ``(dimension, observed)``.
    constant
        ``(dimension,)``.
    matrix
        Of the observation, ``(observed, dimension)``.
    channels
        Names of the components of a state.
    """

    decodes: ClassVar[bool] = True

    gain: FloatArray
    constant: FloatArray
    matrix: FloatArray
    channels: tuple[str, ...] = ()

    @classmethod
    def fit(cls, training: FloatArray, case: EncodingCase) -> Self:
        """Estimate from the moments of the true training states (see `Encoder.fit`).

        With mean m and covariance C of the states, observation matrix H and covariance R of its
        errors, the estimate from y is m + C H' (H C H' + R)^-1 (y - H m).
        """
        if case.observation is None:
            raise ValueError("the state is observed itself: there is nothing to estimate")
        matrix = case.observation.matrix
        noise = np.zeros(len(matrix)) if case.noise is None else case.noise
        if not (noise > 0.0).all():
            raise ValueError("an estimate of the state takes observations with noise, not without")
        moments = state_moments(training.reshape(-1, training.shape[-1]), case.space)
        across = moments.covariance @ matrix.T
        gain = np.linalg.solve(matrix @ across + np.diag(np.square(noise)), across.T).T
        constant = moments.mean - gain @ (matrix @ moments.mean)
        return cls(gain, constant, matrix, component_names(case.space))

    def encode(self, observed: FloatArray) -> FloatArray:
        """Estimates ``(dimension, ...)`` of states from what was observed, ``(observed, ...)``."""
        flat = self.gain @ observed.reshape(len(observed), -1) + self.constant[:, np.newaxis]
        return flat.reshape(-1, *observed.shape[1:])

    def decode(self, channels: FloatArray) -> FloatArray:
        """What instruments see of states ``(dimension, ...)``."""
        return (self.matrix @ channels.reshape(len(channels), -1)).reshape(-1, *channels.shape[1:])

    def record(self) -> dict[str, FloatArray]:
        """Gain, constant and the matrix of the observation."""
        return {"gain": self.gain, "constant": self.constant, "matrix": self.matrix}

    @classmethod
    def restore(cls, record: Mapping[str, FloatArray], case: EncodingCase) -> Self:
        """Put the estimate together again."""
        names = component_names(case.space)
        return cls(record["gain"], record["constant"], record["matrix"], names)
