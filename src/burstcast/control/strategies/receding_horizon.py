"""Receding-horizon control: look again and again, act only while the forecast holds an event.

Every decision looks a horizon ahead, as model predictive control does (e.g. Rawlings, Mayne &
Diehl, "Model Predictive Control", 2017), with a trivial optimisation: the actuator is on or off,
and it is on only if the flow would otherwise have an event. No window and no pause leaves anything
uncovered: the next decision corrects the last.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from burstcast.control.experiment import ControlExperiment, Schedule
from burstcast.control.monitors.base import Monitor
from burstcast.control.monitors.horizon import HorizonMonitor
from burstcast.control.monitors.vote import VoteMonitor
from burstcast.control.sampled.strategy import (
    SampledStrategy,
    check_horizon,
    values_to_tell,
)
from burstcast.control.timing import DecisionTiming
from burstcast.forecasters.base import Forecaster


@dataclass(frozen=True)
class RecedingHorizon(SampledStrategy):
    """Acts until the next decision while the forecast reaches the threshold in the horizon.

    Attributes
    ----------
    horizon_lt
        How far each forecast looks ahead, in Lyapunov times; one step at least.
    margin
        By how much less than the event threshold counts as an event in a forecast, in units of the
        observable; a negative one asks for more.
    vote_share
        Share of several forecasters that must forecast an event: the alarm probability at which a
        committee acts.
    aware
        Whether the forecaster, which must know the parameters, is given the past actuation and the
        actuation already triggered. It then acts on the forecast after the delay. Otherwise it
        forecasts the free flow.
    """

    forecasts: ClassVar[bool] = True

    horizon_lt: float
    margin: float = 0.0
    vote_share: float = 0.5
    aware: bool = False

    @property
    def told(self) -> bool:
        """Whether the forecaster receives the actuation (see `ControlStrategy.told`)."""
        return self.aware

    def horizon(self, timing: DecisionTiming) -> int:
        """Steps that a decision looks ahead."""
        return timing.steps(self.horizon_lt)

    def check(self, schedule: Schedule) -> None:
        """Check that decisions have an interval, and that forecasts look beyond their effect."""
        timing = self.timing(schedule)
        check_horizon(self.horizon(timing), timing, self.horizon_lt, self.aware)

    def monitor(self, experiment: ControlExperiment, forecasters: Sequence[Forecaster]) -> Monitor:
        """Alarms where forecasts hold an event."""
        horizon = self.horizon(self.timing(experiment.schedule))
        observable = experiment.observed_space.observable
        values = values_to_tell(experiment, forecasters) if self.aware else None
        level = experiment.threshold - self.margin
        members = [
            HorizonMonitor(forecaster, observable, horizon, level, values)
            for forecaster in forecasters
        ]
        return members[0] if len(members) == 1 else VoteMonitor(members, self.vote_share)
