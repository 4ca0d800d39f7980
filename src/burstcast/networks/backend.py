"""The interface of an implementation of the reservoir's dynamics."""

import abc
from dataclasses import dataclass

import scipy

from burstcast.base.arrays import FloatArray, Int32Array
from burstcast.networks.readout import ReadoutKind


@dataclass(frozen=True)
class Backend(abc.ABC):
    """Open and closed loop of one reservoir with its hyperparameters applied.

    Arguments are those of `burstcast.networks.dynamics.Dynamics`, which checks them.
    """

    recurrent: "scipy.sparse.csr_array"  #: recurrent weights times the spectral radius
    input_column: Int32Array  #: input that feeds each neuron, the last one being the bias
    input_weight: FloatArray  #: weights of these inputs times the input scaling, ``(neurons,)``
    input_bias: float
    leak_rate: float
    readout: ReadoutKind

    @abc.abstractmethod
    def open_loop(
        self, inputs: FloatArray, states: FloatArray, record: FloatArray | None
    ) -> FloatArray:
        """Final states, driven by data; ``record`` receives the state after each input."""

    @abc.abstractmethod
    def closed_loop(
        self, weights: FloatArray, input_range: FloatArray, states: FloatArray, steps: int
    ) -> tuple[FloatArray, FloatArray]:
        """Outputs and final states of a network that drives itself."""
