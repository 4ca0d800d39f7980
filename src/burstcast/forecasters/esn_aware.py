"""Echo state networks that know the parameters in force: a readout linear in their factors.

The reservoir does not receive the parameters, so that the washout needs no schedule, and one
memory serves forecasts under any schedule (`burstcast.networks.factored`).
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

from burstcast.base.arrays import FloatArray
from burstcast.forecasters._aware import (
    fitted_factors,
    parameters_of,
    recorded_factors,
    restored_factors,
)
from burstcast.forecasters._options import AwareOptions
from burstcast.forecasters._parameter_factors import ParameterFactors
from burstcast.forecasters.base import ForecasterRecord, ForecastingCase, fitted
from burstcast.forecasters.esn import NetworkForecaster
from burstcast.networks.tangent import ClosedLoopTangent
from burstcast.networks.training import TrainingSeries
from burstcast.systems.parameters import Parameters


@dataclass(frozen=True)
class AwareNetworkForecaster(AwareOptions, NetworkForecaster):
    """An echo state network whose closed loop follows a schedule."""

    aware: ClassVar[bool] = True
    learns_parameters: ClassVar[bool] = True

    #: function from values of the parameters to the factors that the readout is linear in
    factors: ParameterFactors = fitted()
    in_force: Parameters = fitted()  #: the parameters, and their values in the case

    def __repr__(self) -> str:
        if self.network is None:
            return f"AwareNetworkForecaster(by {', '.join(self.parameters)})"
        return (
            f"AwareNetworkForecaster(seed {self.seed.seed}: {self.network!r}, "
            f"by {', '.join(self.factors.names)})"
        )

    def _training_series(
        self, training: FloatArray, schedules: FloatArray | None
    ) -> TrainingSeries:
        if schedules is None:
            raise ValueError("the training series of this network have schedules")
        plain = super()._training_series(training, schedules)
        return replace(plain, factors=self.factors(schedules))

    def record(self) -> ForecasterRecord:
        """Record of a plain network with the scaling of the parameters."""
        network, scaling = super().record(), recorded_factors(self.factors)
        return ForecasterRecord(
            {**network.arrays, **scaling.arrays}, {**network.attributes, **scaling.attributes}
        )

    def _knowledge(self, record: ForecasterRecord, case: ForecastingCase) -> dict[str, Any]:
        return {"factors": restored_factors(record, case), "in_force": parameters_of(case)}

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Closed loop under the case's own values (see `Forecaster.advance`)."""
        return self.advance_under(memory, steps, None)

    def advance_under(
        self, memory: FloatArray, steps: int, schedule: FloatArray | None
    ) -> tuple[FloatArray, FloatArray]:
        """Closed loop under a schedule (see `Forecaster.advance_under`)."""
        batch = memory.shape[-1]
        if schedule is None:
            schedule = self.in_force.constant(steps, batch)
        self.in_force.check(schedule, steps, batch)
        return self.network.forecast(memory, steps, self.factors.of_schedule(schedule))

    @cached_property
    def _tangent(self) -> ClosedLoopTangent:
        # perturbations grow under the case's own values
        return ClosedLoopTangent(
            self.network.under(self.factors(self.in_force.constant(1, 1)[0, :, 0]))
        )


def factored_training(
    training: TrainingSeries,
    schedules: FloatArray,
    case: ForecastingCase,
    options: AwareOptions,
) -> tuple[TrainingSeries, ParameterFactors]:
    """Training series of a network that knows the parameters, for its search and its training.

    ``training``: The series without factors. ``schedules``: Values in force from each sample to the
    next, ``(series, time - 1, parameters)``.
    """
    factors = fitted_factors(schedules, case, options)
    return replace(training, factors=factors(schedules)), factors
