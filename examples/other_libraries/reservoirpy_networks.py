"""Echo state networks of ReservoirPy as forecasters of a campaign.

ReservoirPy makes and trains the network. Its hyperparameters are chosen on two training series that
the readout has not seen. The closed loops of all starting points run side by side in NumPy, with
the network's own matrices, since ReservoirPy runs them one after another.
"""

from dataclasses import dataclass

import numpy as np
from held_out import with_chosen_options, with_options
from reservoirpy.nodes import Reservoir, Ridge

from burstcast.forecasters.base import Forecaster, fitted

CHOSEN = ("spectral_radius", "input_scaling", "ridge")


@dataclass(frozen=True)
class ReservoirPy(Forecaster):
    """A network of ReservoirPy: open loop over the washout, closed loop from there on."""

    neurons: int = 500
    squares: bool = False  #: whether the readout has every second neuron squared
    bias: float = 0.2  #: biases of the neurons are uniform up to this
    washout_lt: float = 0.5  #: beginning of each series that training leaves out
    spectral_radius: tuple[float, ...] = (0.2, 0.5, 0.9)
    input_scaling: tuple[float, ...] = (0.1, 0.3, 1.0)
    ridge: tuple[float, ...] = (1e-9, 1e-6, 1e-3)

    mean: np.ndarray = fitted()
    scale: np.ndarray = fitted()
    recurrent: np.ndarray = fitted()
    input_weights: np.ndarray = fitted()
    biases: np.ndarray = fitted()
    weights: np.ndarray = fitted()
    offset: np.ndarray = fitted()
    chosen: np.ndarray = fitted()  #: values of `CHOSEN`

    def fit(self, training, case):
        """Choose hyperparameters, and train the readout on all series."""
        tuned = with_chosen_options(self, CHOSEN, training, case, self.washout_lt)
        (radius,), (scaling,), (ridge,) = (getattr(tuned, name) for name in CHOSEN)
        mean, scale = training.mean(axis=(0, 1)), np.ptp(training, axis=(0, 1))
        reservoir = Reservoir(
            self.neurons,
            sr=radius,
            input_scaling=scaling,
            input_connectivity=0.3,
            rc_connectivity=min(1.0, 20 / self.neurons),
            bias=np.random.default_rng(0).uniform(-self.bias, self.bias, self.neurons),
            seed=0,
        )
        states, targets = [], []
        for series in (training - mean) / scale:
            reservoir.reset() if reservoir.initialized else reservoir.initialize(series[:1])
            states.append(self._features(reservoir.run(series[:-1]).T).T)
            targets.append(series[1:])
        warmup = max(1, int(self.washout_lt * case.steps_per_lyapunov_time))
        readout = Ridge(ridge=ridge).fit(states, targets, warmup=warmup)
        return self.with_fitted(
            mean=mean,
            scale=scale,
            recurrent=_dense(reservoir.W),
            input_weights=_dense(reservoir.Win),
            biases=reservoir.bias,
            weights=readout.Wout,
            offset=readout.bias,
            chosen=np.array([radius, scaling, ridge]),
        )

    def tuned(self):
        """Network that is trained with the hyperparameters that were chosen."""
        return with_options(self, CHOSEN, self.chosen.tolist())

    def start(self, washout):
        """Reservoir states after the washout, ``(neurons, batch)``."""
        state = np.zeros((len(self.biases), washout.shape[2]))
        for observed in washout:
            state = self._driven(state, (observed - self.mean[:, np.newaxis]) / self._scale)
        return state

    def advance(self, memory, steps):
        """Closed loop."""
        outputs = np.empty((steps, len(self.mean), memory.shape[1]))
        for step in range(steps):
            output = self.weights.T @ self._features(memory) + self.offset.reshape(-1, 1)
            outputs[step] = output * self._scale + self.mean[:, np.newaxis]
            memory = self._driven(memory, output)
        return outputs, memory

    @property
    def _scale(self):
        return self.scale[:, np.newaxis]

    def _driven(self, state, inputs):
        driven = self.recurrent @ state + self.input_weights @ inputs
        return np.tanh(driven + self.biases[:, np.newaxis])

    def _features(self, states):
        """States ``(neurons, ...)``, every second neuron squared if the readout has squares.

        The equations of the flow have no symmetry under a change of all signs; tanh has.
        """
        features = states.copy()
        if self.squares:
            features[::2] **= 2
        return features


def _dense(matrix):
    return np.asarray(matrix.toarray() if hasattr(matrix, "toarray") else matrix)
