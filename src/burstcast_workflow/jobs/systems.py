"""System of a job's case: a state with an observable, and equations unless it was measured."""

from collections.abc import Sequence

from burstcast.control.actuation import ActuatorShare
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.parameters import SHARE, Parameters, SystemParameters
from burstcast.systems.registry import make_space, make_system
from burstcast.systems.state_space import MEASURED, StateSpace
from burstcast_workflow.harness.settings import Settings


def system_of(settings: Settings) -> StateSpace:
    """System of a case for forecasts and scores: a dynamical system, or measured series."""
    return make_space(settings["case.system"], settings["case.parameters"])


def parameters_of(settings: Settings, names: Sequence[str]) -> Parameters:
    """Parameters that a case's forecasters know, by name; of a record, columns without values."""
    if settings["case.system"] == MEASURED:
        return Parameters(tuple(names), ())
    if list(names) == [SHARE]:
        actuation = settings.get("case.actuation")
        if actuation is None:
            return Parameters((SHARE,), (0.0,))
        return ActuatorShare.of(equations_of(settings), actuation["parameters"], actuation["force"])
    return SystemParameters.of(equations_of(settings), names)


def equations_of(settings: Settings) -> DynamicalSystem:
    """Dynamical system of a case; a `ValueError` if it was measured and has no equations."""
    return make_system(settings["case.system"], settings["case.parameters"])
