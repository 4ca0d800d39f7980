"""Forecasters that tests make up, and the network of the textbook."""

import numpy as np

from burstcast.forecasters.base import Forecaster


class MadeUpForecaster(Forecaster):
    """Forecaster that is neither fitted nor kept in files: only its forecasts matter."""

    @classmethod
    def fit(cls, training, case, parameters=None):
        raise NotImplementedError

    def record(self):
        raise NotImplementedError

    @classmethod
    def restore(cls, record, case):
        raise NotImplementedError


def textbook_step(dynamics, current, state):
    """One step of one trajectory with dense matrices, number by number where neurons leak.

    ``current``: input that is scaled already, ``(dimension,)``.
    """
    reservoir, leak = dynamics.reservoir, dynamics.leak_rate
    input_matrix = np.zeros((reservoir.neurons, reservoir.dimension + 1))
    input_matrix[np.arange(reservoir.neurons), reservoir.input_column] = reservoir.input_weight
    fed = np.append(current, reservoir.input_bias)
    recurrent = dynamics.spectral_radius * reservoir.recurrent.toarray() @ state
    reached = np.tanh(dynamics.input_scaling * input_matrix @ fed + recurrent)
    return np.array([(1 - leak) * x + leak * y for x, y in zip(state, reached, strict=True)])
