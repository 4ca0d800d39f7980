"""The equations themselves as a forecaster, started from what is observed.

What separates it from the equations that see the truth is the error of the present state alone.
"""

from dataclasses import dataclass
from typing import ClassVar, Self

from burstcast.arrays import FloatArray
from burstcast.forecasters._integrated import IntegratedForecaster
from burstcast.forecasters.base import ForecasterRecord, ForecastingCase
from burstcast.systems.base import DynamicalSystem


@dataclass(frozen=True)
class EquationsFromObservation(IntegratedForecaster):
    """Integrates the equations of the case from the last state of the washout."""

    needs_equations: ClassVar[bool] = True

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
