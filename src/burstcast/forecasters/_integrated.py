"""Forecasters that integrate equations from the last state of the washout, whatever equations."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.forecasters.base import Forecaster, fitted
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.integration import integrate
from burstcast.systems.lyapunov import with_perturbations


@dataclass(frozen=True)
class IntegratedForecaster(Forecaster):
    """Integrates equations from the last state of the washout."""

    may_diverge: ClassVar[bool] = False
    """Whether states that are not finite are a forecast that has diverged, or an error."""

    system: DynamicalSystem = fitted()
    #: time_step, sampling_stride: time step and sampling stride of the integration: time units, and
    #: integration steps in a step of the forecast
    time_step: float = fitted()
    sampling_stride: int = fitted()

    @property
    def memory_size(self) -> int:
        """Components of the state that is integrated: rows of a memory without inputs."""
        return self.system.dimension

    def start(self, washout: FloatArray) -> FloatArray:
        """Last state of the washout, ``(dimension, batch)``."""
        return np.ascontiguousarray(washout[-1])

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Integrate the equations (see `Forecaster.advance`)."""
        samples = integrate(
            self.system,
            memory,
            self.time_step,
            steps * self.sampling_stride,
            stride=self.sampling_stride,
            may_diverge=self.may_diverge,
        )
        return samples[1:], samples[-1]

    def advance_tangent(
        self, memory: FloatArray, tangent: FloatArray, steps: int
    ) -> tuple[FloatArray, FloatArray]:
        """Integrate the linearised equations, too (see `Forecaster.advance_tangent`)."""
        return with_perturbations(
            self.system, memory, tangent, self.time_step, steps * self.sampling_stride
        )
