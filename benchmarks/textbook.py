"""Echo state networks as the paper's equations read: dense matrices, one trajectory at a time.

The yardstick of ``bench.py``; nothing else uses it.
"""

import numpy as np

from burstcast.networks.dynamics import Dynamics


class TextbookNetwork:
    """Reservoir with dense matrices W_in and W."""

    def __init__(self, dynamics: Dynamics) -> None:
        reservoir = dynamics.reservoir
        self._recurrent = dynamics.spectral_radius * reservoir.recurrent.toarray()
        self._input = input_matrix(dynamics)
        self._input_bias = reservoir.input_bias

    def open_loop(self, inputs: np.ndarray, state: np.ndarray) -> np.ndarray:
        """States ``(neurons, steps)`` of one series of inputs ``(steps, dimension)``."""
        states = []
        for current in inputs:
            state = self._step(current, state)
            states.append(state)
        return np.stack(states, axis=1)

    def closed_loop(
        self, weights: np.ndarray, input_range: np.ndarray, state: np.ndarray, steps: int
    ) -> np.ndarray:
        """Forecast ``(steps, dimension)`` of one series."""
        outputs = []
        for _ in range(steps):
            output = weights.T @ np.append(state, 1.0)
            outputs.append(output)
            state = self._step(output / input_range, state)
        return np.stack(outputs)

    def _step(self, current: np.ndarray, state: np.ndarray) -> np.ndarray:
        fed = np.append(current, self._input_bias)
        return np.tanh(self._input @ fed + self._recurrent @ state)


def input_matrix(dynamics: Dynamics) -> np.ndarray:
    """W_in as a dense matrix ``(neurons, dimension + 1)``; its last column belongs to the bias."""
    reservoir = dynamics.reservoir
    matrix = np.zeros((reservoir.neurons, reservoir.dimension + 1))
    rows = np.arange(reservoir.neurons)
    matrix[rows, reservoir.input_column] = dynamics.input_scaling * reservoir.input_weight
    return matrix


def products(states: np.ndarray, targets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """R R^T and R Y^T of states ``(neurons, steps)`` and targets ``(dimension, steps)``."""
    return states @ states.T, states @ targets.T


def ridge(gram: np.ndarray, cross: np.ndarray, tikhonov: float) -> np.ndarray:
    """Solve (R R^T + beta I) W_out = R Y^T."""
    return np.linalg.solve(gram + tikhonov * np.eye(len(gram)), cross)


def integrate(right_hand_side, state: np.ndarray, time_step: float, steps: int) -> np.ndarray:
    """States ``(steps + 1, dimension)`` of one trajectory, by Runge-Kutta of fourth order."""
    states = [state]
    for _ in range(steps):
        k1 = right_hand_side(state)
        k2 = right_hand_side(state + time_step / 2 * k1)
        k3 = right_hand_side(state + time_step / 2 * k2)
        k4 = right_hand_side(state + time_step * k3)
        state = state + time_step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        states.append(state)
    return np.stack(states)
