"""Dynamics of the reservoir in numpy and scipy: the reference for the compiled one.

A trajectory is bit for bit the same whatever batch it is part of: every product is one of a sparse
matrix with a batch, summed in the order of the row's entries, unlike products of BLAS.
"""

import numpy as np
import scipy

from burstcast.base.arrays import FloatArray
from burstcast.networks.backend import Backend
from burstcast.networks.readout import readout_features


class ScipyBackend(Backend):
    """Open and closed loop by products of sparse matrices."""

    def open_loop(
        self, inputs: FloatArray, states: FloatArray, record: FloatArray | None
    ) -> FloatArray:
        """Drive the states by data (see `Backend.open_loop`)."""
        for step, current in enumerate(inputs):
            states = self._step(current, states)
            if record is not None:
                record[:, step] = states
        return states

    def closed_loop(
        self, weights: FloatArray, input_range: FloatArray, states: FloatArray, steps: int
    ) -> tuple[FloatArray, FloatArray]:
        """Let the network drive itself (see `Backend.closed_loop`)."""
        output_matrix = scipy.sparse.csr_array(weights[:-1].T)
        output_bias = weights[-1][:, np.newaxis]
        outputs = np.empty((steps, weights.shape[1], states.shape[1]))
        for step in range(steps):
            outputs[step] = output_matrix @ readout_features(states, self.readout) + output_bias
            states = self._step(outputs[step] / input_range[:, np.newaxis], states)
        return outputs, states

    def _step(self, current: FloatArray, states: FloatArray) -> FloatArray:
        bias = np.full((1, states.shape[1]), self.input_bias)
        fed = np.concatenate([current, bias])[self.input_column]
        reached = np.tanh(self.recurrent @ states + self.input_weight[:, np.newaxis] * fed)
        if self.leak_rate == 1:
            return np.asarray(reached)
        return np.asarray(states + self.leak_rate * (reached - states))
