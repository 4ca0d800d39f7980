"""System of a job's case: a state with an observable, and equations unless it was measured."""

from collections.abc import Mapping, Sequence
from typing import Any

from burstcast.control.actuation import ActuatorShare
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.parameters import SHARE, Parameters, SystemParameters
from burstcast.systems.registry import make_space, make_system
from burstcast.systems.state_space import MEASURED, StateSpace
from burstcast_workflow.harness.settings import JobSettings, at


class System(JobSettings):
    """System of the job's case."""

    system: str = at("case.system")
    parameters: dict[str, Any] = at("case.parameters")

    @property
    def space(self) -> StateSpace:
        """States for forecasts and scores: of a dynamical system, or of measured series."""
        return make_space(self.system, self.parameters)

    @property
    def equations(self) -> DynamicalSystem:
        """Dynamical system; a `ValueError` if the case was measured and has no equations."""
        return make_system(self.system, self.parameters)

    def forecaster_parameters(
        self, names: Sequence[str], actuation: Mapping[str, Any] | None = None
    ) -> Parameters:
        """Parameters that forecasters know, by name; of a record, columns without values."""
        if self.system == MEASURED:
            return Parameters(tuple(names), ())
        if list(names) == [SHARE]:
            if actuation is None:
                return Parameters((SHARE,), (0.0,))
            return ActuatorShare.of(self.equations, actuation["parameters"], actuation["force"])
        return SystemParameters.of(self.equations, names)
