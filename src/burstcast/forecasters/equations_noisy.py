"""The equations as a forecaster, started from the last observed state.

What separates it from the equations that see the truth is the error of the present state alone.
"""

from dataclasses import dataclass, fields
from typing import ClassVar, Self

import numpy as np

from burstcast.arrays import FloatArray
from burstcast.encoders.state_maps import StateMaps
from burstcast.forecasters._integrated import IntegratedForecaster
from burstcast.forecasters.base import ForecasterRecord, ForecastingCase
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.parameters import Parameters, integrate_scheduled


@dataclass(frozen=True)
class EquationsFromObservation(IntegratedForecaster):
    """Integrates the equations of the case from the last state of the washout.

    Where the case has encoded states of a flow, they are decoded first, and the forecast is encoded
    again.
    """

    needs_equations: ClassVar[bool] = True
    aware: ClassVar[bool] = True

    #: equations under other parameters than the case's own, for schedules; None: there are none
    parameters: Parameters | None = None
    #: between states of the equations and channels of the case; None: they are equal
    maps: StateMaps | None = None

    @classmethod
    def fit(
        cls, training: FloatArray, case: ForecastingCase, parameters: FloatArray | None = None
    ) -> Self:
        """Nothing is learnt: the equations are known."""
        return cls.restore(ForecasterRecord(vars(case.maps) if case.maps else {}), case)

    def record(self) -> ForecasterRecord:
        """Nothing was learnt: only the maps to and from channels."""
        return ForecasterRecord(vars(self.maps) if self.maps else {})

    @classmethod
    def restore(cls, record: ForecasterRecord, case: ForecastingCase) -> Self:
        """Take the equations of the case."""
        steps = case.time_step, case.sampling_stride
        if case.source is not None:
            maps = StateMaps(**{one.name: record.arrays[one.name] for one in fields(StateMaps)})
            return cls(case.source, *steps, maps=maps)
        if not isinstance(case.system, DynamicalSystem):
            raise ValueError("measured series have no equations to forecast with")
        return cls(case.system, *steps, case.parameters)

    def start(self, washout: FloatArray, parameters: FloatArray | None = None) -> FloatArray:
        """Last state of the washout, ``(dimension, batch)``, decoded where it is encoded."""
        if self.maps is None:
            return super().start(washout)
        return self.maps.estimates(washout[-1, :-1])

    def advance(
        self, memory: FloatArray, steps: int, parameters: FloatArray | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """Integrate the equations under a schedule (see `Forecaster.advance`)."""
        if self.maps is not None:
            states, memory = super().advance(memory, steps)
            return _with_observable(self.maps, self.system, states), memory
        if parameters is None:
            return super().advance(memory, steps)
        if self.parameters is None:
            raise ValueError("a schedule was given, but the case has no parameters")
        self.parameters.check(parameters, steps, memory.shape[-1])
        samples = integrate_scheduled(
            self.parameters, parameters, memory, self.time_step, self.sampling_stride
        )
        return samples[1:], samples[-1]


def _with_observable(maps: StateMaps, system: DynamicalSystem, states: FloatArray) -> FloatArray:
    """Channels of states ``(steps, dimension, batch)``, the observable as the last one."""
    return np.stack([np.vstack([maps.channels(one), system.observable(one)]) for one in states])
