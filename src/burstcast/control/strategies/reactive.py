"""Reactive control: act while an observed quantity is high, without a forecast.

The baseline of every strategy that forecasts: what is gained by looking ahead is what is left
against the best threshold on what is observed now. What is watched may be any expression of the
components, and an actuator that is a force may push either way: "push mode 3 against the sign of
a2 while a1 is high" is a reactive strategy.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ClassVar

from burstcast.arrays import FloatArray
from burstcast.control.experiment import ControlExperiment
from burstcast.control.monitors.base import Monitor
from burstcast.control.monitors.observed import ObservedMonitor
from burstcast.control.sampled.strategy import SampledStrategy
from burstcast.discovery import suggestion
from burstcast.forecasters.base import Forecaster
from burstcast.systems.expressions import Expression
from burstcast.systems.state_space import StateSpace, component_names


@dataclass(frozen=True)
class Reactive(SampledStrategy):
    """Acts until the next decision while a quantity of the observed state is at or above a level.

    Attributes
    ----------
    level
        In units of what is watched. Of the observable: below the event threshold, or it acts too
        late.
    watch
        What is watched: an expression of the components by their names, and of ``observable``.
        Empty: the observable.
    push
        Expression that decides the sign of the actuator's force: where it is negative, the force
        is reversed. Empty: the force is never reversed.
    """

    forecasts: ClassVar[bool] = False

    level: float
    watch: str = ""
    push: str = ""

    def check_system(self, system: StateSpace, reversible: bool) -> None:
        """Check expressions, and that a push can be reversed (see `ControlStrategy`)."""
        for expression in filter(None, (self.watch, self.push)):
            quantity(expression, system)
        if self.push and not reversible:
            raise ValueError(
                f"the actuation cannot push by {self.push!r}: only a force can be reversed"
            )

    def monitor(self, experiment: ControlExperiment, forecasters: Sequence[Forecaster]) -> Monitor:
        """Alarms where the watched quantity is high now (see `ControlStrategy.monitor`)."""
        system = experiment.observed_space
        self.check_system(system, experiment.reversed_system is not None)
        watched = quantity(self.watch, system) if self.watch else system.observable
        return ObservedMonitor(
            watched, self.level, quantity(self.push, system) if self.push else None
        )


def quantity(expression: str, space: StateSpace) -> Callable[[FloatArray], FloatArray]:
    """Quantity of states ``(dimension, ...)``, from an expression of their components.

    Parameters
    ----------
    expression
        Expression of the components by their names, and of ``observable``.
    space
        What the states are.

    Raises
    ------
    ValueError
        If the expression is not understood, or has another name.
    """
    found, names = Expression(expression), component_names(space)
    unknown = sorted(set(found.names) - {*names, "observable"})
    if unknown:
        raise ValueError(
            f"{expression!r} has the unknown name {unknown[0]!r}"
            f"{suggestion(unknown[0], (*names, 'observable'))}; known are {', '.join(names)} and "
            f"observable"
        )

    def of_states(states: FloatArray) -> FloatArray:
        values = dict(zip(names, states, strict=True))
        if "observable" in found.names:
            values["observable"] = space.observable(states)
        return found(values)

    return of_states
