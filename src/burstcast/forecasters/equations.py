"""The equations themselves as a forecaster: as good as knowing the state allows."""

from dataclasses import dataclass

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.forecasters.base import Forecaster
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.integration import integrate


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
