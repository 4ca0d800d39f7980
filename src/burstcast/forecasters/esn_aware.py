"""Echo state networks that know the parameters in force: a readout linear in their factors.

The reservoir does not receive the parameters, so that the washout needs none of them, and one
memory serves forecasts under any of their values (`burstcast.networks.factored`).
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

from burstcast.base.arrays import FloatArray
from burstcast.base.exogenous import carry, of_washout
from burstcast.forecasters._options import AwareOptions
from burstcast.forecasters._parameter_factors import ParameterFactors, factored
from burstcast.forecasters.base import ForecasterRecord, ForecastingCase, fitted
from burstcast.forecasters.esn import NetworkForecaster
from burstcast.networks.factored import forecast_under, network_under
from burstcast.networks.tangent import ClosedLoopTangent
from burstcast.networks.training import TrainingSeries
from burstcast.systems.parameters import Parameters


@dataclass(frozen=True)
class AwareNetworkForecaster(AwareOptions, NetworkForecaster):
    """An echo state network whose closed loop depends on parameters."""

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

    def _training_series(self, training: FloatArray) -> TrainingSeries:
        plain = super()._training_series(training)
        return factored(plain, self.factors, self.in_force)

    def record(self) -> ForecasterRecord:
        """Record of a plain network with the scaling of the parameters."""
        network, scaling = super().record(), self.factors.record()
        return ForecasterRecord(
            {**network.arrays, **scaling.arrays}, {**network.attributes, **scaling.attributes}
        )

    def _knowledge(self, record: ForecasterRecord, case: ForecastingCase) -> dict[str, Any]:
        return {
            "factors": ParameterFactors.restored(record, case.required_parameters),
            "in_force": case.required_parameters,
        }

    def start(self, washout: FloatArray) -> FloatArray:
        """Reservoir states after the washout, ``(neurons, batch)``."""
        states, _, ahead = of_washout(washout, len(self.network.input_range))
        return carry(super().start(states), ahead)

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Closed loop under the inputs (see `Forecaster.advance`)."""
        neurons = self.network.dynamics.reservoir.neurons
        states, schedule, later = self.in_force.over(memory, neurons, steps)
        factors = self.factors.of_schedule(schedule)
        outputs, states = forecast_under(self.network, states, factors)
        return outputs, carry(states, later)

    @cached_property
    def _tangent(self) -> ClosedLoopTangent:
        # perturbations grow under the case's own values
        return ClosedLoopTangent(
            network_under(self.network, self.factors(self.in_force.constant(1, 1)[0, :, 0]))
        )
