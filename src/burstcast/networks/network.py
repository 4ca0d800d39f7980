"""A trained echo state network: dynamics, normalisation and readout."""

from dataclasses import dataclass

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.networks.dynamics import Dynamics
from burstcast.networks.readout import Readout


@dataclass(frozen=True)
class EchoStateNetwork:
    """A trained network, in the units of the data.

    Parameters
    ----------
    dynamics
        The reservoir with its hyperparameters.
    readout
        The trained output weights. Those of a network that was trained with factors of parameters
        are linear in them (`burstcast.networks.factored`).
    input_range
        Range of each component over the training data, which the inputs are divided by, shape
        ``(dimension,)``.
    input_offset
        What is subtracted from the inputs before that, and added to the outputs of the readout,
        shape ``(dimension,)``; None: nothing.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.data.dataset import component_scales
    >>> from burstcast.networks.dynamics import Dynamics
    >>> from burstcast.networks.network import EchoStateNetwork
    >>> from burstcast.networks.reservoir import make_reservoir
    >>> from burstcast.networks.training import TrainingSeries, train
    >>> from burstcast.systems.integration import integrate
    >>> from burstcast.systems.lorenz63 import Lorenz63
    >>> start = np.array([[1.0], [1.0], [20.0]]) + np.random.default_rng(0).normal(size=(3, 5))
    >>> series = integrate(Lorenz63(), start, 0.01, 4000, stride=2)[500:].transpose(2, 0, 1)
    >>> scales = component_scales(series[:4])
    >>> reservoir = make_reservoir(200, 3, 20, 0.1, np.random.default_rng(1))
    >>> dynamics = Dynamics(reservoir, spectral_radius=0.4, input_scaling=1.0)
    >>> training = TrainingSeries(series[:4], scales.range)
    >>> readout = train(dynamics, training, washout=50, tikhonov=1e-9)
    >>> network = EchoStateNetwork(dynamics, readout, scales.range)
    >>> washout = series[4:, :100].transpose(1, 2, 0)
    >>> forecast, _ = network.forecast(network.washout(washout), steps=50)
    >>> error = np.abs(forecast[:, :, 0] - series[4, 100:150]).max(axis=1)
    >>> forecast.shape, bool(error[:20].max() < 1.0)
    ((50, 3, 1), True)
    """

    dynamics: Dynamics
    readout: Readout
    input_range: FloatArray
    input_offset: FloatArray | None = None

    def __repr__(self) -> str:
        """Size and hyperparameters, no matrices."""
        dynamics = self.dynamics
        leak = f", leak rate {dynamics.leak_rate:.3g}" if dynamics.leak_rate != 1 else ""
        readout = f", {dynamics.readout} readout" if dynamics.readout != "linear" else ""
        return (
            f"EchoStateNetwork({dynamics.reservoir.neurons} neurons, "
            f"{len(self.input_range)} components, "
            f"spectral radius {dynamics.spectral_radius:.3g}, "
            f"input scaling {dynamics.input_scaling:.3g}, Tikhonov {self.readout.tikhonov:.0e}"
            f"{leak}{readout})"
        )

    def washout(self, inputs: FloatArray, states: FloatArray | None = None) -> FloatArray:
        """States ``(neurons, batch)`` after data ``(steps, dimension, batch)``.

        The data end with the starting point of the forecast itself. ``states``: Initial states;
        None: zero.
        """
        centred = self._centred(inputs) / self.input_range[:, np.newaxis]
        return self.dynamics.open_loop(centred, states)

    def forecast(self, states: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Autonomous forecast from the states after a washout.

        Parameters
        ----------
        states
            Shape ``(neurons, batch)``; not changed.
        steps
            Length of the forecast.

        Returns
        -------
        outputs
            Shape ``(steps, dimension, batch)``, in the units of the data; the first lies one step
            after the last input of the washout.
        states
            Shape ``(neurons, batch)``; a call with them continues the forecast.

        Raises
        ------
        ValueError
            If a shape does not fit or a state is not finite.
        """
        weights = self.readout.weights
        outputs, states = self.dynamics.closed_loop(weights, self.input_range, states, steps)
        if self.input_offset is not None:
            outputs = outputs + self.input_offset[:, np.newaxis]
        return outputs, states

    def _centred(self, data: FloatArray) -> FloatArray:
        """Data ``(steps, dimension, batch)`` less the offset."""
        return data if self.input_offset is None else data - self.input_offset[:, np.newaxis]
