"""The linearised closed loop of a network: growth of small perturbations of its reservoir.

With the reservoir states r, one step of the closed loop is

    r' = (1 - a) r + a t,    t = tanh(rho W r + sigma_in W_in [u; b_in]),
    u = diag(1 / range) W_out^T [f(r); 1],

with the leak rate a and the readout's features f (1 and r in the paper), so that its Jacobian is

    J = (1 - a) I + a diag(1 - t^2) (rho W + sigma_in W_in diag(1 / range) W_out^T diag(f'(r))),

where W_in and W_out are without the bias. J is dense, but the sum of a sparse matrix and a matrix
whose rank is the output's dimension: it is applied factor by factor, and never formed.

Source: Margazoglou & Magri, "Stability analysis of chaotic systems from data", Nonlinear Dynamics
111 (2023) 8799, for networks of this kind.
"""

import numpy as np
import scipy

from burstcast.base.arrays import FloatArray
from burstcast.networks.network import EchoStateNetwork


class ClosedLoopTangent:
    """Propagates perturbations of a network's reservoir states along its closed loop.

    All products are of a sparse matrix with a batch, and independent of the batch, bit for bit.
    """

    def __init__(self, network: EchoStateNetwork) -> None:
        self._network = network
        dynamics = network.dynamics
        reservoir = dynamics.reservoir
        neurons, dimension = reservoir.neurons, reservoir.dimension
        self._recurrent = reservoir.recurrent * dynamics.spectral_radius
        # the neurons that are fed an output; the others are fed the bias, which nothing perturbs
        fed = np.flatnonzero(reservoir.input_column < dimension)
        column = reservoir.input_column[fed]
        weight = dynamics.input_scaling * reservoir.input_weight[fed] / network.input_range[column]
        self._feedback = scipy.sparse.csr_array((weight, (fed, column)), (neurons, dimension))
        self._readout = scipy.sparse.csr_array(network.readout.weights[:-1].T)

    def advance(
        self, states: FloatArray, tangent: FloatArray, steps: int
    ) -> tuple[FloatArray, FloatArray]:
        """States ``(neurons, batch)`` and perturbations ``(neurons, n, batch)`` after steps."""
        shape = tangent.shape
        for _ in range(steps):
            before = states
            _, states = self._network.forecast(before, 1)
            columns = tangent.reshape(shape[0], -1)
            seen = self._seen(before, tangent).reshape(shape[0], -1)
            grown = self._recurrent @ columns + self._feedback @ (self._readout @ seen)
            grown = grown.reshape(shape)
            leak = self._network.dynamics.leak_rate
            if leak == 1:
                tangent = grown * (1.0 - states * states)[:, np.newaxis]
            else:
                reached = before + (states - before) / leak
                grown *= (1.0 - reached * reached)[:, np.newaxis]
                tangent = (1.0 - leak) * tangent + leak * grown
        return states, tangent

    def _seen(self, states: FloatArray, tangent: FloatArray) -> FloatArray:
        """Perturbations of the readout's features."""
        if self._network.dynamics.readout == "linear":
            return tangent
        seen = tangent.copy()
        seen[1::2] *= 2.0 * states[1::2, np.newaxis]
        return seen
