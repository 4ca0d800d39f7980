"""The echo state network as a forecaster."""

from dataclasses import dataclass

from burstcast.arrays import BoolArray, FloatArray
from burstcast.esn.network import EchoStateNetwork
from burstcast.forecasters.base import Forecaster


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
