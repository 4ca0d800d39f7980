"""Prediction-triggered control: an alarm for a window sets off one actuation of a given length.

Source: section "Control of extreme events" of the paper.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from burstcast.arrays import BoolArray, IntArray
from burstcast.control.monitors.base import Decision
from burstcast.control.simulation import (
    ControlSimulation,
    RunningFlows,
    Stepper,
    ending_at,
    observable_of,
)
from burstcast.control.timing import Timing
from burstcast.events import upward_crossings
from burstcast.forecast.windows import crosses_in_window
from burstcast.systems.integration import integrate_switched


@dataclass(frozen=True)
class Forecasts:
    """All forecasts that were made, flow by flow in the order of time.

    The last windows may reach beyond the last step of the flows: forecasts are made as long as an
    actuation could still begin before it.

    Attributes
    ----------
    flow
        Position of each forecast's flow among the simulated flows, ``(forecasts,)``.
    step
        Step at which the forecast was made, ``(forecasts,)``.
    alarm
        Whether it raised an alarm, ``(forecasts,)``.
    would_cross
        Whether, after an alarm, the flow would have crossed the threshold in the window had the
        alarm not been acted on, ``(forecasts,)``; False where there was no alarm.
    would_be_under_way
        Whether, after an alarm that was not acted on, the flow would have been at or above the
        threshold at the window's first step already, ``(forecasts,)``; likewise.
    reached
        Whether, after an alarm that was acted on, the flow was at or above the threshold in the
        window, or crossed it between the start of the actuation and the window, ``(forecasts,)``;
        likewise.
    """

    flow: IntArray
    step: IntArray
    alarm: BoolArray
    would_cross: BoolArray
    would_be_under_way: BoolArray
    reached: BoolArray


WindowedSimulation = ControlSimulation[Timing, Forecasts]


@dataclass(frozen=True)
class WindowedStepper(Stepper[Timing, Forecasts]):
    """Looks window by window, and acts for a while on each alarm.

    Where an actuation is still on at the next alarm, it stays on until the later of the two ends.

    Attributes
    ----------
    interval
        First integration step after an alarm under actuation, and the first free one after it
        (`burstcast.control.actuation.actuation_interval`).
    """

    judgements: ClassVar[tuple[str, ...]] = ("would_cross", "would_be_under_way")

    interval: tuple[int, int]

    @property
    def effect(self) -> tuple[int, int]:
        """The interval of the actuation (see `Stepper.effect`)."""
        return self.interval

    @property
    def pauses(self) -> tuple[int, int]:
        """A window; after an alarm, up to the end of its window (see `Stepper.pauses`)."""
        return self.timing.window_steps, self.timing.window_end

    def judge(self, flows: RunningFlows, due: IntArray, decision: Decision) -> dict[str, BoolArray]:
        """Simulate flows after an alarm without actuation.

        An earlier actuation that is still on stays on (see `Stepper.judge`).
        """
        alarm = decision.alarm
        crosses, under_way = np.zeros_like(alarm), np.zeros_like(alarm)
        if alarm.any():
            timing, alarmed = self.timing, due[alarm]
            stride, now = timing.sampling_stride, flows.clock[alarmed]
            ahead = now[:, np.newaxis] * stride + np.arange(timing.window_end * stride)
            samples = integrate_switched(
                self.systems,
                flows.acting[alarmed[:, np.newaxis], ahead].T,
                flows.states[alarmed, now].T,
                timing.time_step,
                stride,
            )
            otherwise = observable_of(self.system, samples.transpose(2, 0, 1)).T
            crosses[alarm] = crosses_in_window(
                otherwise[1:], timing.window_start, timing.window_end, self.threshold
            )
            under_way[alarm] = otherwise[timing.window_start] >= self.threshold
        return {"would_cross": crosses, "would_be_under_way": under_way}

    def decisions(self, flows: RunningFlows, position: int) -> Forecasts:
        """All forecasts, flow by flow in the order of time (see `Stepper.decisions`)."""
        timing = self.timing
        made = np.arange(timing.most_forecasts) < flows.looks[:, np.newaxis]
        flow, step, alarm = np.nonzero(made)[0], flows.step[made], flows.alarm[made]
        since_alarm = ending_at(
            flows.states, flow[alarm], step[alarm] + timing.window_end, timing.window_end + 1
        )
        observable = observable_of(self.system, since_alarm)
        upward = upward_crossings(observable, self.threshold)
        # a step under actuation in part is one that actuation could have changed
        first = self.interval[0] // timing.sampling_stride
        before_window = upward[:, first + 1 : timing.window_start + 1].any(axis=1)
        in_window = (observable[:, timing.window_start :] >= self.threshold).any(axis=1)
        reached = np.zeros_like(alarm)
        reached[alarm] = before_window | in_window
        judged = {name: values[made] for name, values in flows.judged.items()}
        return Forecasts(flow=position + flow, step=step, alarm=alarm, reached=reached, **judged)
