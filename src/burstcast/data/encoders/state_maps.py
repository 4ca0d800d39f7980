"""Affine maps between states of a flow and the channels of a case."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.files.described import Described
from burstcast.base.files.units import COMPONENT, COMPONENT_PRODUCT, COMPONENT_RATIO


@dataclass(frozen=True)
class StateMaps:
    """Affine maps between states of a flow and channels, and the covariance of the states.

    A state is estimated as ``gain @ channels + constant``; the channels of a state are
    ``matrix @ state + offset``.
    """

    gain: Annotated[
        FloatArray,
        Described(
            "dimension channel", COMPONENT_RATIO, "from channels to an estimate of the state"
        ),
    ]
    constant: Annotated[
        FloatArray, Described("dimension", COMPONENT, "estimate of the state for channels of zero")
    ]
    matrix: Annotated[
        FloatArray, Described("channel dimension", COMPONENT_RATIO, "from states to channels")
    ]
    offset: Annotated[FloatArray, Described("channel", COMPONENT, "channels of the state zero")]
    #: covariance of the states, averaged over the symmetries of their system, ``(dimension,
    #: dimension)``
    covariance: Annotated[
        FloatArray, Described("dimension dimension", COMPONENT_PRODUCT, "covariance of the states")
    ]

    def estimates(self, channels: FloatArray) -> FloatArray:
        """States ``(dimension, batch)`` estimated from channels ``(channel, batch)``."""
        return self.gain @ channels + self.constant[:, np.newaxis]

    def channels(self, states: FloatArray) -> FloatArray:
        """Channels ``(channel, batch)`` of states ``(dimension, batch)``."""
        return self.matrix @ states + self.offset[:, np.newaxis]

    def error_covariance(self, noise: FloatArray) -> FloatArray:
        """Covariance of the error of an estimate from channels, ``(dimension, dimension)``.

        ``noise``: Standard deviation of the errors of the channels, ``(channel,)``.
        """
        lost = np.eye(len(self.gain)) - self.gain @ self.matrix
        noisy = self.gain * noise
        return lost @ self.covariance @ lost.T + noisy @ noisy.T
