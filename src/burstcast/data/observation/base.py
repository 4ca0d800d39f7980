"""The interface of an observation: sensor readings of the state of a flow."""

import abc

import numpy as np

from burstcast.base.arrays import FloatArray


class Observation(abc.ABC):
    """A linear map from states to observations, without noise."""

    @property
    @abc.abstractmethod
    def channels(self) -> tuple[str, ...]:
        """Names of the observed components."""

    @property
    @abc.abstractmethod
    def matrix(self) -> FloatArray:
        """Matrix of the map, ``(observed, dimension)``."""

    def __call__(self, states: FloatArray) -> FloatArray:
        """Observe states ``(dimension, ...)``: ``(observed, ...)``, without noise."""
        return np.tensordot(self.matrix, states, axes=1)
