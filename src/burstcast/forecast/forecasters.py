"""The forecasters: an echo state network, and the equations themselves."""

from dataclasses import dataclass

import numpy as np

from burstcast.arrays import BoolArray, FloatArray
from burstcast.esn.network import EchoStateNetwork
from burstcast.forecast.base import Forecaster
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.integration import integrate


@dataclass(frozen=True)
class NetworkForecaster(Forecaster):
    """An echo state network: open loop over the washout, closed loop from there on.

    Attributes
    ----------
    network
        The trained network.
    divergence_bound
        A forecast beyond this many training ranges of any component has diverged.
    """

    network: EchoStateNetwork
    divergence_bound: float

    def start(self, washout: FloatArray) -> FloatArray:
        """Reservoir states after the washout, ``(neurons, batch)``."""
        return self.network.washout(washout)

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Closed loop (see `Forecaster.advance`)."""
        return self.network.forecast(memory, steps)

    def diverged(self, outputs: FloatArray) -> BoolArray:
        """Tell which forecasts are not finite or beyond the divergence bound."""
        return self.network.diverged(outputs, self.divergence_bound)


@dataclass(frozen=True)
class EquationsForecaster(Forecaster):
    """The equations themselves, started from the last state of the washout."""

    system: DynamicalSystem
    time_step: float
    sampling_stride: int

    def start(self, washout: FloatArray) -> FloatArray:
        """Last observed state, ``(dimension, batch)``."""
        return np.ascontiguousarray(washout[-1])

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Integrate the equations (see `Forecaster.advance`)."""
        samples = integrate(
            self.system,
            memory,
            self.time_step,
            steps * self.sampling_stride,
            stride=self.sampling_stride,
        )
        return samples[1:], samples[-1]
