"""The equations themselves as a forecaster, started from what is observed.

What separates it from the equations that see the truth is the error of the present state alone.
"""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.forecasters.base import Forecaster, ForecasterRecord, ForecastingCase
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.integration import integrate
from burstcast.systems.lyapunov import with_perturbations


@dataclass(frozen=True)
class EquationsFromObservation(Forecaster):
    """Integrates the equations from the last state of the washout.

    Attributes
    ----------
    system
        The equations.
    time_step, sampling_stride
        Of the integration: time units, and integration steps in a step of the forecast.
    """

    needs_equations: ClassVar[bool] = True

    system: DynamicalSystem
    time_step: float
    sampling_stride: int

    @classmethod
    def fit(cls, training: FloatArray, case: ForecastingCase) -> Self:
        """Nothing is learnt: the equations are known."""
        return cls.restore(ForecasterRecord(), case)

    def record(self) -> ForecasterRecord:
        """Nothing was learnt."""
        return ForecasterRecord()

    @classmethod
    def restore(cls, record: ForecasterRecord, case: ForecastingCase) -> Self:
        """Take the equations of the case.

        Raises
        ------
        ValueError
            If it has none: its series were measured.
        """
        if not isinstance(case.system, DynamicalSystem):
            raise ValueError("measured series have no equations to forecast with")
        return cls(case.system, case.time_step, case.sampling_stride)

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
        )
        return samples[1:], samples[-1]

    def advance_tangent(
        self, memory: FloatArray, tangent: FloatArray, steps: int
    ) -> tuple[FloatArray, FloatArray]:
        """Integrate the linearised equations, too (see `Forecaster.advance_tangent`)."""
        return with_perturbations(
            self.system, memory, tangent, self.time_step, steps * self.sampling_stride
        )
