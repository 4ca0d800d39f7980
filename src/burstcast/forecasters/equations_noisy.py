"""The equations as a forecaster, started from the last observed state.

What separates it from the equations that see the truth is the error of the present state alone.
"""

from dataclasses import dataclass, fields
from typing import Any, ClassVar, Self

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.exogenous import carry, of_washout
from burstcast.data.encoders.state_maps import StateMaps
from burstcast.forecasters._integrated import IntegratedForecaster
from burstcast.forecasters.base import ForecasterRecord, ForecastingCase, fitted
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

    #: equations under other parameters than the case's own, for inputs; None: there are none
    in_force: Parameters | None = fitted()
    #: between states of the equations and channels of the case; None: they are equal
    maps: StateMaps | None = fitted()

    def fit(self, training: FloatArray, case: ForecastingCase) -> Self:
        """Nothing is learnt: the equations are known."""
        return self.restore(ForecasterRecord(vars(case.maps) if case.maps else {}), case)

    def record(self) -> ForecasterRecord:
        """Nothing was learnt: only the maps to and from channels."""
        return ForecasterRecord(vars(self.maps) if self.maps else {})

    def restore(self, record: ForecasterRecord, case: ForecastingCase) -> Self:
        """Take the equations of the case."""
        steps: dict[str, Any] = {
            "time_step": case.time_step,
            "sampling_stride": case.sampling_stride,
        }
        if case.source is not None:
            arrays = {entry.name: record.arrays[entry.name] for entry in fields(StateMaps)}
            maps = StateMaps(**arrays)
            return self.with_fitted(system=case.source, maps=maps, **steps)
        if not isinstance(case.system, DynamicalSystem):
            raise ValueError("measured series have no equations to forecast with")
        return self.with_fitted(system=case.system, in_force=case.parameters, **steps)

    def start(self, washout: FloatArray) -> FloatArray:
        """Last state of the washout, ``(dimension, batch)``, decoded where it is encoded.

        Inputs of an encoded flow are ignored.
        """
        if self.maps is not None:
            states, _, _ = of_washout(washout, 1 + len(self.maps.matrix))
            return self.maps.estimates(states[-1, :-1])
        states, _, ahead = of_washout(washout, self.memory_size)
        return carry(super().start(states), ahead)

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Integrate the equations (see `Forecaster.advance`); encode what was decoded."""
        size = self.memory_size
        if self.maps is not None:
            states, memory = super().advance(memory[:size], steps)
            # channels, and the observable as the last one
            channels = [
                (self.maps.channels(state), self.system.observable(state)) for state in states
            ]
            return np.stack([np.vstack(pair) for pair in channels]), memory
        if len(memory) == size:
            return super().advance(memory, steps)
        if self.in_force is None:
            raise ValueError("inputs were given, but the case has no parameters")
        state, schedule, later = self.in_force.over(memory, size, steps)
        samples = integrate_scheduled(
            self.in_force, schedule, state, self.time_step, self.sampling_stride
        )
        return samples[1:], carry(samples[-1], later)
