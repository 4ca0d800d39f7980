"""Who forecasts: anything that turns an observed washout into a continuation of it.

Scoring, prediction horizon and control know only this interface. A forecaster's memory is an array
whose last axis is the batch, so that forecasts can be picked out and put aside at any step.
"""

import abc
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from burstcast.esn.network import EchoStateNetwork
from burstcast.systems.base import DynamicalSystem, FloatArray
from burstcast.systems.integration import integrate


class Forecaster(abc.ABC):
    """Continues many observed series at once."""

    @abc.abstractmethod
    def start(self, washout: FloatArray) -> FloatArray:
        """Memory after an observed washout.

        Parameters
        ----------
        washout
            Observed states up to and including the starting point, ``(steps, dimension, batch)``.

        Returns
        -------
        Memory, ``(..., batch)``.
        """

    @abc.abstractmethod
    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Forecast the next steps.

        Returns
        -------
        Forecast states ``(steps, dimension, batch)``, the first one step after the starting point
        or after the last forecast state, and the memory from which the forecast goes on.
        """

    def diverged(self, outputs: FloatArray) -> npt.NDArray[np.bool_]:
        """Tell which forecasts ``(steps, dimension, batch)`` have left the finite numbers."""
        return np.asarray(~np.isfinite(outputs).all(axis=(0, 1)))


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

    def diverged(self, outputs: FloatArray) -> npt.NDArray[np.bool_]:
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
