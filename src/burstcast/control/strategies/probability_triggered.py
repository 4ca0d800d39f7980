"""Control by probabilities: act for a while once an event is probable.

For classifiers, which give probabilities of events in windows ahead and no trajectory. A window
knows nothing of an event that has begun before it, so that each alarm sets off the actuation for a
time in which the event that it was raised for would pass.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from burstcast.base.arrays import BoolArray
from burstcast.control.experiment import ControlExperiment
from burstcast.control.policy import Look, Policy
from burstcast.control.strategies.base import SampledStrategy
from burstcast.control.timing import Schedule


@dataclass(frozen=True)
class ProbabilityTriggered(SampledStrategy):
    """Acts for a while on each alarm, which a probability raises."""

    forecasts = by_probability = True

    #: probability of an event at which an alarm is raised, in (0, 1)
    probability: float
    #: how long each alarm sets off the actuation, in Lyapunov times: the time between decisions at
    #: least
    hold_lt: float
    #: how many prediction windows count, from the first: the largest of their probabilities decides
    windows: float = 1.0

    def hold(self, schedule: Schedule) -> int:
        """Steps of the actuation that an alarm sets off."""
        return schedule.steps(self.hold_lt)

    def check(self, schedule: Schedule) -> None:
        """Check the probability, the windows, and how long an alarm acts."""
        timing = self.timing(schedule)
        if not 0 < self.probability < 1:
            raise ValueError(f"probability must lie between 0 and 1, not be {self.probability:g}")
        if not (self.windows >= 1 and float(self.windows).is_integer()):
            raise ValueError(f"windows must be a whole number from 1 on, not {self.windows:g}")
        if self.hold(schedule) < timing.pauses[0]:
            raise ValueError(
                f"hold_lt must be at least decision_interval_lt, {self.decision_interval_lt:g}, "
                f"not {self.hold_lt:g}"
            )

    def policy(self, experiment: ControlExperiment, forecaster: Any) -> Policy:
        """Act where an event is at least as probable as the level in any window that counts."""
        self.check(experiment.schedule)

        def decide(look: Look) -> BoolArray:
            washouts = np.ascontiguousarray(look.washout.transpose(2, 0, 1))
            probabilities = forecaster.probabilities(washouts)[:, : int(self.windows)]
            return np.asarray((probabilities >= self.probability).any(axis=1))

        return decide
