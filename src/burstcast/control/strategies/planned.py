"""Planned control: forecast the effect of several actuations, and take the cheapest.

Plans have the actuator on once, from one of several starts and for one of several durations. It
acts only if the flow would otherwise have an event, as late and as briefly as suffices.
"""

from dataclasses import dataclass

from burstcast.arrays import BoolArray
from burstcast.control.sampled.planning import PlanningStrategy, pulses
from burstcast.control.timing import DecisionTiming


@dataclass(frozen=True)
class Planned(PlanningStrategy):
    """Plans actuations that are on once.

    Attributes
    ----------
    starts_lt
        Starts of the actuation after the effect of a decision, in Lyapunov times; 0 among them, or
        it never acts.
    durations_lt
        Durations of the actuation, in Lyapunov times; one step at least.
    """

    starts_lt: tuple[float, ...] = (0.0, 0.25, 0.5, 1.0)
    durations_lt: tuple[float, ...] = (0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0)

    def sequences(self, timing: DecisionTiming) -> BoolArray:
        """All pairs of starts and durations (see `PlanningStrategy.sequences`)."""
        steps = self.horizon(timing) - timing.delay
        starts = [timing.steps(start) for start in self.starts_lt]
        lengths = [timing.steps(duration) for duration in self.durations_lt]
        if 0 not in starts:
            raise ValueError(f"no plan acts at once: starts_lt is {list(self.starts_lt)}")
        if not lengths or min(lengths) < 1:
            raise ValueError(
                f"an actuation lasts no step: durations_lt is {list(self.durations_lt)}"
            )
        if max(lengths) > steps or max(starts) >= steps:
            raise ValueError(
                f"plans are longer than the horizon: {self.horizon_lt} Lyapunov times less a delay "
                f"of {timing.delay_lt}, but durations_lt is {list(self.durations_lt)} and "
                f"starts_lt is {list(self.starts_lt)}"
            )
        return pulses(starts, lengths, steps)
