"""Control at fixed sampling intervals: look, switch on or off, look again.

Receding-horizon control is of this kind, and so is a rule that reacts to what is observed now; they
differ in the monitor.

The monitor is given the last observed states, whatever equations they came under. Those under
actuation belong to another flow than the one that forecasters were trained on; what is asked of a
forecaster is the free flow from the present state on, were the actuation off. The present state
lies in the same state space, and a reservoir forgets its inputs within a few steps, but its washout
is not one that it has seen. Each decision is therefore also compared with the truth, apart for
decisions whose washout has steps under actuation and for those whose has none (`Decisions`).
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from burstcast.arrays import BoolArray, IntArray
from burstcast.control.simulation import (
    ControlSimulation,
    RunningFlows,
    Stepper,
    ending_at,
    observable_of,
)
from burstcast.control.timing import DecisionTiming
from burstcast.systems.integration import integrate


@dataclass(frozen=True)
class Decisions:
    """All decisions, each ``(flows, timing.most_forecasts)``.

    Attributes
    ----------
    on
        Whether the actuation was switched on.
    event_ahead
        Whether the free flow from the state at the decision, under no actuation from there on, is
        at or above the event threshold within the horizon; None for a horizon of 0.
    washout_actuated
        Whether the flow came to any step of the washout, after its first, under actuation.
    """

    on: BoolArray
    event_ahead: BoolArray | None
    washout_actuated: BoolArray


SampledSimulation = ControlSimulation[DecisionTiming, Decisions]


@dataclass(frozen=True)
class SampledStepper(Stepper[DecisionTiming, Decisions]):
    """Looks at equal intervals: the actuation is on until the next decision takes effect, or off.

    Attributes
    ----------
    horizon
        Steps after a decision over which it is compared with the free flow; 0: it is not.
    """

    judgements: ClassVar[tuple[str, ...]] = ("event_ahead", "washout_actuated")

    horizon: int = 0

    @property
    def effect(self) -> tuple[int, int]:
        """An interval, a delay after the decision (see `Stepper.effect`)."""
        timing = self.timing
        start = timing.delay * timing.sampling_stride
        return start, start + timing.interval * timing.sampling_stride

    @property
    def pauses(self) -> tuple[int, int]:
        """An interval, whatever was decided (see `Stepper.pauses`)."""
        return self.timing.interval, self.timing.interval

    def judge(self, flows: RunningFlows, due: IntArray, alarm: BoolArray) -> dict[str, BoolArray]:
        """Look at the free flow ahead, and at the washout behind (see `Stepper.judge`)."""
        stride, now = self.timing.sampling_stride, flows.clock[due]
        behind = ending_at(flows.acting, due, now * stride - 1, (self.timing.washout - 1) * stride)
        ahead = np.zeros_like(alarm)
        if self.horizon:
            samples = integrate(
                self.system,
                np.ascontiguousarray(flows.states[due, now].T),
                self.timing.time_step,
                self.horizon * stride,
                stride=stride,
            )
            free = observable_of(self.system, samples[1:].transpose(2, 0, 1))
            ahead |= (free >= self.threshold).any(axis=1)
        return {"event_ahead": ahead, "washout_actuated": np.any(behind, axis=1)}

    def decisions(self, flows: RunningFlows, position: int) -> Decisions:
        """All decisions (see `Stepper.decisions`)."""
        judged = flows.judged
        ahead = judged["event_ahead"] if self.horizon else None
        return Decisions(flows.alarm, ahead, judged["washout_actuated"])
