"""An echo state network of ReservoirPy for a case of the benchmark.

::

    python reservoirpy_esn.py CASE.nc FORECASTS.nc [NEURONS]

ReservoirPy makes and trains the network. Its hyperparameters are chosen on two training series that
the readout has not seen. The closed loops of all starting points run side by side in NumPy, with
the network's own matrices, since ReservoirPy runs them one after another.
"""

import sys
from functools import partial

import numpy as np
from closed_loop import enter
from reservoirpy.nodes import Reservoir, Ridge

GRID = {
    "spectral_radius": (0.2, 0.5, 0.9),
    "input_scaling": (0.1, 0.3, 1.0),
    "ridge": (1e-9, 1e-6, 1e-3),
}


class Network:
    """A trained network, whose closed loops run side by side."""

    def __init__(self, training, washout, spectral_radius, input_scaling, ridge, neurons):
        self.mean, self.scale = training.mean(axis=(0, 1)), np.ptp(training, axis=(0, 1))
        reservoir = Reservoir(
            neurons,
            sr=spectral_radius,
            input_scaling=input_scaling,
            input_connectivity=0.3,
            rc_connectivity=min(1.0, 20 / neurons),
            bias=np.random.default_rng(0).uniform(-0.2, 0.2, neurons),
            seed=0,
        )
        states, targets = [], []
        for series in (training - self.mean) / self.scale:
            reservoir.initialize(series[:1]) if not reservoir.initialized else reservoir.reset()
            states.append(with_squares(reservoir.run(series[:-1])))
            targets.append(series[1:])
        readout = Ridge(ridge=ridge).fit(states, targets, warmup=washout)
        self.recurrent, self.fed = reservoir.W, reservoir.Win.toarray()
        self.bias = reservoir.bias[:, np.newaxis]
        self.weights, self.offset = readout.Wout, readout.bias

    def step(self, state, inputs):
        """Next states of reservoirs, ``(neurons, batch)``."""
        return np.tanh(self.recurrent @ state + self.fed @ inputs + self.bias)

    def forecast(self, washouts, steps):
        """Forecasts after washouts, both ``(points, steps, component)``."""
        inputs = ((washouts - self.mean) / self.scale).transpose(1, 2, 0)
        state = np.zeros((len(self.bias), len(washouts)))
        for one in inputs:
            state = self.step(state, one)
        found = np.empty((len(washouts), steps, washouts.shape[2]))
        for step in range(steps):
            output = with_squares(state.T) @ self.weights + self.offset
            found[:, step] = output * self.scale + self.mean
            state = self.step(state, output.T)
        return found


def with_squares(states):
    """Reservoir states ``(steps, neurons)``, every other neuron squared.

    The equations of the flow have no symmetry under a change of all signs; tanh has.
    """
    found = states.copy()
    found[:, ::2] **= 2
    return found


def main(case_path, path, neurons=500):
    """Write forecasts of a case."""
    enter(partial(Network, neurons=int(neurons)), GRID, case_path, path)


if __name__ == "__main__":
    main(*sys.argv[1:])
