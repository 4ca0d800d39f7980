"""Reactive control: act while an observed quantity is high, without a forecast.

The baseline of every strategy that forecasts: what is gained by looking ahead is what is left
against the best threshold on what is observed now. What is watched may be any expression of the
components, and an actuator that is a force may push either way: "push mode 3 against the sign of
a2 while a1 is high" is a reactive strategy.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from burstcast.base.arrays import ByteArray, FloatArray
from burstcast.base.discovery import suggestion
from burstcast.base.expressions import Expression
from burstcast.control.actuation import REVERSED
from burstcast.control.experiment import ControlExperiment
from burstcast.control.policy import Look, Policy
from burstcast.control.strategies.base import SampledStrategy
from burstcast.systems.state_space import StateSpace, component_names


@dataclass(frozen=True)
class Reactive(SampledStrategy):
    """Acts until the next decision while an observed quantity is at or above a level."""

    #: in units of what is watched. Of the observable: below the event threshold, or it acts too
    #: late
    level: float
    #: what is watched: an expression of the components by their names, and of ``observable``.
    #: Empty: the observable
    watch: str = ""
    #: expression that decides the sign of the actuator's force: where it is negative, the force is
    #: reversed. Empty: the force is never reversed
    push: str = ""

    def check_system(self, system: StateSpace, reversible: bool) -> None:
        """Check expressions, and that a push can be reversed."""
        for expression in filter(None, (self.watch, self.push)):
            quantity(expression, system)
        if self.push and not reversible:
            raise ValueError(
                f"the actuation cannot push by {self.push!r}: only a force can be reversed"
            )

    def policy(self, experiment: ControlExperiment, forecaster: Any) -> Policy:
        """Act where the watched quantity of the last observed state is high."""
        space = experiment.observed_space
        self.check_system(space, experiment.reversed_system is not None)
        watched = quantity(self.watch or "observable", space)
        push = quantity(self.push, space) if self.push else None

        def decide(look: Look) -> ByteArray:
            now = look.washout[-1]
            decided = np.where(watched(now) >= self.level, 1, 0)
            if push is not None:
                decided[(decided == 1) & (push(now) < 0)] = REVERSED
            return decided.astype(np.uint8)

        return decide


def quantity(expression: str, space: StateSpace) -> Callable[[FloatArray], FloatArray]:
    """Quantity of states ``(dimension, ...)``: an expression of components and ``observable``."""
    watched, names = Expression(expression), component_names(space)
    unknown = sorted(set(watched.names) - {*names, "observable"})
    if unknown:
        raise ValueError(
            f"{expression!r} has the unknown name {unknown[0]!r}"
            f"{suggestion(unknown[0], (*names, 'observable'))}; known are {', '.join(names)} and "
            f"observable"
        )

    def of_states(states: FloatArray) -> FloatArray:
        values = dict(zip(names, states, strict=True))
        if "observable" in watched.names:
            values["observable"] = space.observable(states)
        return watched(values)

    return of_states
