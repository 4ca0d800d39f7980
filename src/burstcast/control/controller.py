"""Controllers of one's own: the interface observe -> act, on which a benchmark compares them.

A controller is a class with two methods. At each decision it observes the flows, with noise and
never the truth, and acts on them. `burstcast.control.arenas` has the flows that controllers are
compared on, and `burstcast check-controller` checks a controller before.
"""

import abc
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.discovery import made, own_class
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.state_space import StateSpace


@dataclass(frozen=True)
class ControlTask:
    """Facts that a controller gets before the first decision. Its arrays cannot be changed."""

    space: StateSpace  #: what is observed: its dimension, its observable
    threshold: float  #: value of the observable that is an extreme event
    interval: float  #: time between two observations, in time units
    stride: int  #: integration steps from one observation to the next
    steps_per_lyapunov_time: int  #: observations in a Lyapunov time
    between: int  #: observations from one decision to the next
    window: int  #: observations that are shown at each decision, the last one is now
    noise: FloatArray  #: standard deviation of the observation noise, ``(components,)``
    actuators: int  #: number of actuators
    limit: float  #: largest absolute action of an actuator
    switched: bool  #: an actuator is off (0) or on (``limit``), with nothing between
    most: int  #: actuators that may act at the same decision
    training: FloatArray  #: observed series without control, ``(series, time, components)``
    #: the equations without actuation, for controllers that are allowed a perfect model
    equations: DynamicalSystem

    def __post_init__(self) -> None:
        """Keep copies that no controller can change: others get the same facts."""
        for name in ("noise", "training"):
            kept = np.array(getattr(self, name))
            kept.flags.writeable = False
            object.__setattr__(self, name, kept)


class Controller(abc.ABC):
    """Controller of many flows at once, each of which it controls by itself.

    Fields of a subclass, a dataclass, are its options.

    Examples
    --------
    >>> import numpy as np
    >>> from dataclasses import dataclass
    >>> from burstcast.control.controller import Controller
    >>> @dataclass
    ... class WhileHigh(Controller):
    ...     level: float
    ...
    ...     def observe(self, observations):
    ...         self.observable = self.task.space.observable(observations[-1])
    ...
    ...     def act(self):
    ...         return np.where(self.observable >= self.level, self.task.limit, 0.0)[np.newaxis]
    """

    task: ControlTask

    def begin(self, task: ControlTask, flows: int) -> None:
        """Prepare for a run with so many flows: learn a model, say.

        A subclass that extends it calls ``super().begin(task, flows)``, which keeps the task, makes
        random generators anew, and leaves nothing of an earlier run.
        """
        self.task = task

    @abc.abstractmethod
    def observe(self, observations: FloatArray) -> None:
        """Observe the flows up to now, ``(window, components, flows)``; `act` follows."""

    @abc.abstractmethod
    def act(self) -> FloatArray:
        """Act until the next decision, ``(actuators, flows)``; 0 is no action.

        Absolute values are at most ``task.limit``, and at most ``task.most`` of a flow's are not 0.
        """


def make_controller(name: str, options: Mapping[str, Any]) -> Controller:
    """Make a controller of a class, ``my_controllers:Slope``, from values of its options.

    Raises ValueError if there is no such class or option, or a value is of another type.

    Examples
    --------
    >>> make_controller("burstcast.control.rules:WhileRising", {"level": 0.1, "ahead": 30})
    WhileRising(level=0.1, ahead=30.0)
    """
    if ":" not in name:
        raise ValueError(f"{name!r} names no controller: write <module>:<class>")
    kind: type[Controller] = own_class(name, Controller, "controller")  # type: ignore[type-abstract]
    return made("controller", name, "option", kind, options)
