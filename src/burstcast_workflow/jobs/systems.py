"""What a job's case has: a state with an observable, and equations, unless it was measured."""

from burstcast.systems.base import DynamicalSystem
from burstcast.systems.registry import make_space, make_system
from burstcast.systems.state_space import StateSpace
from burstcast_workflow.harness.settings import Settings


def system_of(settings: Settings) -> StateSpace:
    """What forecasts and scores ask about a case: a dynamical system, or measured series."""
    return make_space(settings["case.system"], settings["case.parameters"])


def equations_of(settings: Settings) -> DynamicalSystem:
    """The dynamical system of a case (a ValueError if it was measured: it has no equations)."""
    return make_system(settings["case.system"], settings["case.parameters"])
