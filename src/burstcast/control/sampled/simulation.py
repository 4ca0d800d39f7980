"""Control at fixed sampling intervals: look, switch on or off, look again.

Receding-horizon control is of this kind, and so is a rule that reacts to what is observed now; they
differ in the monitor.

The monitor is given the last observed states, whatever equations they came under. Those under
actuation belong to another flow than the one that forecasters were trained on; a forecaster
forecasts the free flow from the present state, as if the actuation were off. The present state
lies in the same state space, and a reservoir forgets its inputs within a few steps, but the washout
is unlike any in training. Each decision is therefore also compared with the truth, separately
for decisions with and without actuation in their washout (`Decisions`).

A forecaster that knows the parameters may be given the past actuation and the actuation already
triggered. Its decisions are compared with the true flow under the same assumption: the triggered
actuation, then none. A monitor that plans is compared with the true flow under its own plan, too.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from burstcast.arrays import BoolArray, ByteArray, IntArray
from burstcast.control.monitors.base import Decision
from burstcast.control.simulation import (
    ControlSimulation,
    RunningFlows,
    Stepper,
    ending_at,
    observable_of,
)
from burstcast.control.timing import DecisionTiming
from burstcast.systems.integration import integrate, integrate_switched


@dataclass(frozen=True)
class Decisions:
    """All decisions, each ``(flows, timing.most_forecasts)``.

    Attributes
    ----------
    on
        Whether the actuation was switched on.
    event_ahead
        Whether the free flow from the state at the decision, under no actuation from there on, is
        at or above the event threshold within the horizon; None for a horizon of 0. Where the
        monitor knows the actuation: whether the flow is, after the step at which the decision takes
        effect, under no other actuation than the one already triggered.
    washout_actuated
        Whether the flow came to any step of the washout, after its first, under actuation.
    plan_fails
        Whether the true flow under the monitor's plan is at or above the event threshold within
        the horizon, after the step at which the decision takes effect; None if it does not plan.
    """

    on: BoolArray
    event_ahead: BoolArray | None
    washout_actuated: BoolArray
    plan_fails: BoolArray | None = None


SampledSimulation = ControlSimulation[DecisionTiming, Decisions]


@dataclass(frozen=True)
class SampledStepper(Stepper[DecisionTiming, Decisions]):
    """Looks at equal intervals: the actuation is on until the next decision takes effect, or off.

    Attributes
    ----------
    horizon
        Steps after a decision over which it is compared with the free flow; 0: it is not.
    told
        Whether the monitor knows the actuation.
    hold
        Steps of the actuation that an alarm sets off; 0: until the next decision takes effect.
    """

    judgements: ClassVar[tuple[str, ...]] = ("event_ahead", "washout_actuated", "plan_fails")

    horizon: int = 0
    told: bool = False
    hold: int = 0

    @property
    def effect(self) -> tuple[int, int]:
        """An interval, or what an alarm holds, a delay after the decision (see `Stepper.effect`).

        A later decision without an alarm ends no actuation that holds.
        """
        timing = self.timing
        start = timing.delay * timing.sampling_stride
        return start, start + (self.hold or timing.interval) * timing.sampling_stride

    @property
    def pauses(self) -> tuple[int, int]:
        """An interval, whatever was decided (see `Stepper.pauses`)."""
        return self.timing.interval, self.timing.interval

    def judge(self, flows: RunningFlows, due: IntArray, decision: Decision) -> dict[str, BoolArray]:
        """Look at the true flow ahead, and at the washout behind (see `Stepper.judge`)."""
        stride, now = self.timing.sampling_stride, flows.clock[due]
        behind = ending_at(flows.acting, due, now * stride - 1, (self.timing.washout - 1) * stride)
        ahead, fails = np.zeros_like(decision.alarm), np.zeros_like(decision.alarm)
        if self.told:
            # what is decided already lasts as long as the delay
            acting = np.zeros((self.horizon * stride, len(due)), dtype=np.uint8)
            pending = np.arange(self.timing.delay * stride)
            steps = now[:, np.newaxis] * stride + pending
            acting[: len(pending)] = flows.acting[due[:, np.newaxis], steps].T
            ahead |= self._reaches(flows, due, acting)
            if decision.plan is not None:
                planned = np.repeat(decision.plan.astype(np.uint8), stride, axis=0)
                fails |= self._reaches(flows, due, planned)
        elif self.horizon:
            samples = integrate(
                self.system,
                np.ascontiguousarray(flows.states[due, now].T),
                self.timing.time_step,
                self.horizon * stride,
                stride=stride,
            )
            free = observable_of(self.system, samples[1:].transpose(2, 0, 1))
            ahead |= (free >= self.threshold).any(axis=1)
        return {
            "event_ahead": ahead,
            "washout_actuated": np.any(behind, axis=1),
            "plan_fails": fails,
        }

    def _reaches(self, flows: RunningFlows, due: IntArray, acting: ByteArray) -> BoolArray:
        """Whether true flows reach the threshold after the delay, under an actuation to come.

        ``acting`` is ``(integration steps, due)``, as of `RunningFlows.acting`.
        """
        samples = integrate_switched(
            self.systems,
            np.ascontiguousarray(acting),
            np.ascontiguousarray(flows.states[due, flows.clock[due]].T),
            self.timing.time_step,
            self.timing.sampling_stride,
        )
        observable = observable_of(self.system, samples[1:].transpose(2, 0, 1))
        return np.asarray((observable[:, self.timing.delay :] >= self.threshold).any(axis=1))

    def decisions(self, flows: RunningFlows, position: int) -> Decisions:
        """All decisions (see `Stepper.decisions`)."""
        judged = flows.judged
        ahead = judged["event_ahead"] if self.horizon else None
        fails = judged["plan_fails"] if self.monitor.plans else None
        return Decisions(flows.alarm, ahead, judged["washout_actuated"], fails)
