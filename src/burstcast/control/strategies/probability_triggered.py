"""Control by probabilities: act for a while once an event is probable.

For classifiers, which give probabilities of events in windows ahead and no trajectory. A window
knows nothing of an event that has begun before it, so that each alarm sets off the actuation for a
time in which the event that it was raised for would pass.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, cast

from burstcast.control.experiment import ControlExperiment, Schedule
from burstcast.control.monitors.base import Monitor
from burstcast.control.monitors.probability import ProbabilityMonitor
from burstcast.control.sampled.strategy import SampledStrategy
from burstcast.control.timing import DecisionTiming
from burstcast.forecasters._event_classifier import EventClassifier
from burstcast.forecasters.base import ForecasterKind


@dataclass(frozen=True)
class ProbabilityTriggered(SampledStrategy):
    """Acts for a while on each alarm, which a probability raises.

    Attributes
    ----------
    probability
        Probability of an event at which an alarm is raised, in (0, 1).
    hold_lt
        How long each alarm sets off the actuation, in Lyapunov times: the time between decisions at
        least.
    windows
        How many prediction windows count, from the first: the actuation is set off by the largest
        of their probabilities.
    """

    forecasts: ClassVar[bool] = True
    by_probability: ClassVar[bool] = True

    probability: float
    hold_lt: float
    windows: float = 1.0

    def hold(self, timing: DecisionTiming) -> int:
        """Steps of the actuation that an alarm sets off."""
        return timing.steps(self.hold_lt)

    def check(self, schedule: Schedule) -> None:
        """Check the probability, the windows, and how long an alarm acts."""
        timing = self.timing(schedule)
        if not 0 < self.probability < 1:
            raise ValueError(f"probability must lie between 0 and 1, not be {self.probability:g}")
        if not (self.windows >= 1 and float(self.windows).is_integer()):
            raise ValueError(f"windows must be a whole number from 1 on, not {self.windows:g}")
        if self.hold(timing) < timing.interval:
            raise ValueError(
                f"hold_lt must be at least decision_interval_lt, {self.decision_interval_lt:g}, "
                f"not {self.hold_lt:g}"
            )

    def monitor(
        self, experiment: ControlExperiment, forecasters: Sequence[ForecasterKind]
    ) -> Monitor:
        """Alarms where an event is probable (see `ControlStrategy.monitor`)."""
        (classifier,) = forecasters
        self.check(experiment.schedule)
        given = cast(EventClassifier, classifier)
        return ProbabilityMonitor(given, int(self.windows), self.probability)
