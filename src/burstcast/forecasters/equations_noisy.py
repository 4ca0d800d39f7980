"""The equations as a forecaster, started from the last observed state.

What separates it from the equations that see the truth is the error of the present state alone.
"""

from dataclasses import dataclass
from typing import ClassVar, Self

from burstcast.arrays import FloatArray
from burstcast.forecasters._integrated import IntegratedForecaster
from burstcast.forecasters.base import ForecasterRecord, ForecastingCase
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.parameters import Parameters, integrate_scheduled


@dataclass(frozen=True)
class EquationsFromObservation(IntegratedForecaster):
    """Integrates the equations of the case from the last state of the washout.

    Attributes
    ----------
    parameters
        Equations under other parameters than the case's own, for schedules; None: there are none.
    """

    needs_equations: ClassVar[bool] = True
    aware: ClassVar[bool] = True

    parameters: Parameters | None = None

    @classmethod
    def fit(
        cls, training: FloatArray, case: ForecastingCase, parameters: FloatArray | None = None
    ) -> Self:
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
        return cls(case.system, case.time_step, case.sampling_stride, case.parameters)

    def advance(
        self, memory: FloatArray, steps: int, parameters: FloatArray | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """Integrate the equations under a schedule (see `Forecaster.advance`).

        Raises
        ------
        ValueError
            If there is a schedule, and the case has no parameters.
        """
        if parameters is None:
            return super().advance(memory, steps)
        if self.parameters is None:
            raise ValueError("a schedule was given, but the case has no parameters")
        self.parameters.check(parameters, steps, memory.shape[-1])
        samples = integrate_scheduled(
            self.parameters, parameters, memory, self.time_step, self.sampling_stride
        )
        return samples[1:], samples[-1]
