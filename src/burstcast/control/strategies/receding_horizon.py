"""Receding-horizon control: forecast at every decision, act while an event is forecast.

Every decision looks a horizon ahead, as model predictive control does (e.g. Rawlings, Mayne &
Diehl, "Model Predictive Control", 2017), with a trivial optimisation: the actuator is on or off,
and it is on only if the flow would otherwise have an event. An event that is under way counts like
one that is still to come. Where a forecast is invalid up to the horizon, the fallback decides.

The forecaster receives the last observed states, with or without actuation, and forecasts the free
flow from the present state, as if the actuation were off. States under actuation lie in the same
space, and a reservoir forgets its inputs within a few steps, but such a washout does not occur in
training.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from burstcast.base.arrays import ByteArray
from burstcast.base.exogenous import carry
from burstcast.control.experiment import ControlExperiment
from burstcast.control.policy import (
    Fallback,
    Look,
    Policy,
    forecast,
    informed_memory,
    is_invalid,
)
from burstcast.control.strategies.base import ForesightedStrategy


@dataclass(frozen=True)
class RecedingHorizon(ForesightedStrategy):
    """Acts until the next decision while the forecast reaches the threshold in the horizon."""

    #: whether the forecaster, which must know the parameters, is given the past actuation and the
    #: actuation already triggered. It then forecasts the flow with the actuator off from the step
    #: at which the decision takes effect, and only later steps count
    aware: bool = False

    @property
    def informed(self) -> bool:
        """Whether the forecaster receives the actuation."""
        return self.aware

    def policy(self, experiment: ControlExperiment, forecaster: Any) -> Policy:
        """Policy that acts if the forecast reaches the level at any step up to the horizon."""
        self.check(experiment.schedule)
        horizon, level = self.horizon(experiment.schedule), self.level(experiment)
        observable = experiment.observed_space.observable
        values = self.values(experiment, forecaster) if self.aware else None

        fallback = Fallback(self.fallback, experiment)

        def decide(look: Look) -> ByteArray:
            if values is None:
                states = forecast(forecaster, look, horizon)
            else:
                memory = informed_memory(forecaster, look, values)
                off = np.zeros((horizon - look.delay, memory.shape[-1]), dtype=bool)
                outputs, _ = forecaster.advance(carry(memory, values.schedule(off)), len(off))
                states = forecaster.valid(outputs).transpose(1, 0, 2)
            reached = np.asarray((observable(states) >= level).any(axis=0))
            return fallback.where(is_invalid(states), reached, look)

        return decide
