"""Planning strategies: the base class of families of action sequences.

A family of plans is a strategy of its own: a subclass of `PlanningStrategy` that lists the plans.
"""

import abc
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from burstcast.arrays import BoolArray
from burstcast.control.actuation import REVERSED
from burstcast.control.experiment import ControlExperiment, Schedule
from burstcast.control.monitors.base import Monitor
from burstcast.control.monitors.planned import PlannedMonitor
from burstcast.control.monitors.vote import VoteMonitor
from burstcast.control.sampled.strategy import SampledStrategy, check_horizon, values_to_tell
from burstcast.control.timing import DecisionTiming
from burstcast.forecasters.base import Forecaster
from burstcast.systems.state_space import StateSpace


@dataclass(frozen=True)
class PlanningStrategy(SampledStrategy):
    """Forecasts action sequences, begins with the best one, and plans anew at each decision.

    Model-predictive control (e.g. Rawlings, Mayne & Diehl, "Model Predictive Control", 2017) with
    an actuator that is on or off: the optimisation is a search through a list of plans
    (`burstcast.control.monitors.planned`).

    Attributes
    ----------
    horizon_lt
        How far forecasts look ahead, in Lyapunov times from the decision; beyond the delay.
    margin
        By how much less than the event threshold a forecast must stay, in units of the observable.
    vote_share
        Share of several forecasters whose plan must act at once; each plans for itself.
    reversible
        Whether each plan is forecast with the reversed force, too.
    """

    forecasts: ClassVar[bool] = True

    horizon_lt: float
    margin: float = 0.0
    vote_share: float = 0.5
    reversible: bool = False

    @property
    def told(self) -> bool:
        """Forecasters receive the actuation (see `ControlStrategy.told`)."""
        return True

    @abc.abstractmethod
    def sequences(self, timing: DecisionTiming) -> BoolArray:
        """Plans: whether the actuator is on at each step from the effect of a decision on.

        Parameters
        ----------
        timing
            Timing of the decisions.

        Returns
        -------
        ``(plans, steps)``, up to the horizon; no two alike.

        Raises
        ------
        ValueError
            If a plan does not end within the horizon, or there is none that acts.
        """

    def horizon(self, timing: DecisionTiming) -> int:
        """Steps that a decision looks ahead."""
        return timing.steps(self.horizon_lt)

    def check(self, schedule: Schedule) -> None:
        """Check that forecasts look beyond a decision's effect, and plans end within them."""
        timing = self.timing(schedule)
        check_horizon(self.horizon(timing), timing, self.horizon_lt, self.told)
        self.sequences(timing)

    def check_system(self, system: StateSpace, reversible: bool) -> None:
        """Check that a force is there to be reversed (see `ControlStrategy`)."""
        if self.reversible and not reversible:
            raise ValueError("plans cannot be reversible: only a force can be reversed")

    def monitor(self, experiment: ControlExperiment, forecasters: Sequence[Forecaster]) -> Monitor:
        """Alarms where the best plan acts at once (see `ControlStrategy.monitor`)."""
        self.check(experiment.schedule)
        self.check_system(experiment.system, experiment.reversed_system is not None)
        if self.reversible and len(forecasters) > 1:
            raise ValueError("several forecasters cannot vote about the direction of a force")
        sequences = self.sequences(self.timing(experiment.schedule)).astype(np.uint8)
        if self.reversible:
            sequences = np.concatenate([sequences, REVERSED * sequences])
        members = [
            PlannedMonitor(
                forecaster,
                experiment.observed_space.observable,
                experiment.threshold - self.margin,
                values_to_tell(experiment, forecasters),
                sequences,
            )
            for forecaster in forecasters
        ]
        return members[0] if len(members) == 1 else VoteMonitor(members, self.vote_share)


def pulses(starts: Sequence[int], lengths: Sequence[int], steps: int) -> BoolArray:
    """Plans that are on once: from each start, for each length.

    Parameters
    ----------
    starts, lengths
        Starts and lengths in steps.
    steps
        Length of the plans; longer actuations are cut at their end.

    Returns
    -------
    ``(plans, steps)``, no two alike, in the order of starts and lengths.
    """
    found: dict[bytes, BoolArray] = {}
    for start in starts:
        for length in lengths:
            plan = np.zeros(steps, dtype=bool)
            plan[start : start + length] = True
            if plan.any():
                found.setdefault(plan.tobytes(), plan)
    return np.array(list(found.values())).reshape(-1, steps)
