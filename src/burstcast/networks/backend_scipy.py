"""Dynamics of the reservoir in numpy and scipy: the plain implementation.

It is the reference for `burstcast.networks.backend_compiled`, and the fallback where that does not
run. The state of a trajectory is bit for bit the same whatever batch it is part of: every product
is one of a sparse matrix with a batch, summed in the order of the row's entries. (A product of BLAS
would depend on the size of the batch.)
"""

import numpy as np
import scipy.sparse

from burstcast.base.arrays import FloatArray, Int32Array
from burstcast.networks.readout import ReadoutKind, readout_features


class ScipyBackend:
    """Open and closed loop of one reservoir with its hyperparameters applied.

    ``recurrent``: Recurrent weights times the spectral radius, shape ``(neurons, neurons)``.
    ``input_column``, ``input_weight``: The input that feeds each neuron (the last one is the bias)
    and its weight times the input scaling, shape ``(neurons,)``. ``leak_rate``, ``readout``: See
    `burstcast.networks.dynamics.Dynamics`.
    """

    def __init__(
        self,
        recurrent: scipy.sparse.csr_array,
        input_column: Int32Array,
        input_weight: FloatArray,
        input_bias: float,
        leak_rate: float,
        readout: ReadoutKind,
    ) -> None:
        self._recurrent = recurrent
        self._input_column = input_column
        self._input_weight = input_weight
        self._input_bias = input_bias
        self._leak_rate = leak_rate
        self._readout: ReadoutKind = readout

    def open_loop(
        self, inputs: FloatArray, states: FloatArray, record: FloatArray | None
    ) -> FloatArray:
        """Drive the states by data, as `burstcast.networks.dynamics.Dynamics.open_loop` does.

        ``record``, of shape ``(neurons, steps, batch)``, receives the state after each input.
        """
        for step, current in enumerate(inputs):
            states = self._step(current, states)
            if record is not None:
                record[:, step] = states
        return states

    def closed_loop(
        self, weights: FloatArray, input_range: FloatArray, states: FloatArray, steps: int
    ) -> tuple[FloatArray, FloatArray]:
        """Let the network drive itself; see `burstcast.networks.dynamics.Dynamics.closed_loop`."""
        output_matrix = scipy.sparse.csr_array(weights[:-1].T)
        output_bias = weights[-1][:, np.newaxis]
        outputs = np.empty((steps, weights.shape[1], states.shape[1]))
        for step in range(steps):
            outputs[step] = output_matrix @ readout_features(states, self._readout) + output_bias
            states = self._step(outputs[step] / input_range[:, np.newaxis], states)
        return outputs, states

    def _step(self, current: FloatArray, states: FloatArray) -> FloatArray:
        bias = np.full((1, states.shape[1]), self._input_bias)
        fed = np.concatenate([current, bias])[self._input_column]
        reached = np.tanh(self._recurrent @ states + self._input_weight[:, np.newaxis] * fed)
        if self._leak_rate == 1:
            return np.asarray(reached)
        return np.asarray(states + self._leak_rate * (reached - states))
