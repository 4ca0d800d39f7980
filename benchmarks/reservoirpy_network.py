"""The same network in ReservoirPy, which somebody would otherwise use.

A yardstick of ``bench.py``; nothing else uses it.
"""

import numpy as np
from reservoirpy.nodes import Reservoir, Ridge
from textbook import input_matrix

from burstcast.networks.dynamics import Dynamics
from burstcast.networks.training import TrainingSeries


class ReservoirpyNetwork:
    """Reservoir with the same sparse matrix, and a readout of its own."""

    def __init__(self, dynamics: Dynamics) -> None:
        reservoir = dynamics.reservoir
        fed = input_matrix(dynamics)
        self._reservoir = Reservoir(
            W=dynamics.spectral_radius * reservoir.recurrent,
            Win=fed[:, :-1],
            bias=reservoir.input_bias * fed[:, -1],
            lr=1.0,
            activation="tanh",
        )
        self._reservoir.initialize(np.zeros(reservoir.dimension))
        self._readout = Ridge()

    def train(self, training: TrainingSeries, washout: int, tikhonov: float) -> None:
        """Train the readout on all series, whose states are held at once, as its users do."""
        states, targets = [], []
        for series in training.observed:
            self._reservoir.reset()
            states.append(self._reservoir.run(series[:-1] / training.input_range))
            targets.append(series[1:])
        self._readout = Ridge(ridge=tikhonov).fit(states, targets, warmup=washout - 1)

    def closed_loop(self, input_range: np.ndarray, states: np.ndarray, steps: int) -> np.ndarray:
        """Forecasts ``(steps, dimension, trajectories)``, one trajectory after the other."""
        outputs = np.empty((steps, len(input_range), states.shape[1]))
        for trajectory, state in enumerate(states.T):
            self._reservoir.state = {"out": state}
            for step in range(steps):
                outputs[step, :, trajectory] = self._readout.step(self._reservoir.state["out"])
                self._reservoir.step(outputs[step, :, trajectory] / input_range)
        return outputs
