"""Flows under prediction-triggered control, many side by side, each beside its uncontrolled twin.

Source: section "Control of extreme events" of the paper.
"""

from dataclasses import dataclass

import numpy as np

from burstcast.arrays import BoolArray, FloatArray, IntArray
from burstcast.control.actuation import Actuation
from burstcast.control.followed import (
    FollowedFlows,
    actuated_samples,
    concatenated,
    counted_actuation,
    energy_means,
)
from burstcast.control.monitors.base import Monitor
from burstcast.control.states import (
    check_given,
    flow_batches,
    observable_of,
    quiet_flows,
    stretches_ending_at,
    uncontrolled_flows,
)
from burstcast.control.timing import Timing
from burstcast.events import upward_crossings
from burstcast.forecast.windows import crosses_in_window
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.integration import integrate_switched


@dataclass(frozen=True)
class Forecasts:
    """All forecasts that were made, flow by flow in the order of time.

    Attributes
    ----------
    flow
        Position of each forecast's flow among those that count, ``(forecasts,)``.
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


@dataclass(frozen=True)
class ControlledFlows(FollowedFlows):
    """Flows under prediction-triggered control, and the same flows without it.

    Attributes
    ----------
    timing
        Which steps count, and where the windows are.
    forecasts
        What the monitor said, and what came of it. The last windows may reach beyond the last step
        of the flows: forecasts are made as long as an actuation could still begin before it.
    """

    timing: Timing
    forecasts: Forecasts


def run_controlled_flows(
    system: DynamicalSystem,
    washouts: FloatArray,
    monitor: Monitor,
    actuation: Actuation,
    timing: Timing,
    threshold: float,
    *,
    noise: FloatArray | None = None,
    quiet_starts: bool = True,
    keep_states: bool = False,
) -> ControlledFlows:
    """Follow flows under control, and the same flows without it.

    Each flow has its own clock; all move together. At each of its forecasts the monitor sees the
    last observed states. On an alarm the flow is integrated on under the actuation's equations over
    the actuation's interval and under its own equations before and after it; that is the new truth.
    Where an actuation is still on at the next alarm, it stays on until the later of the two ends.

    A flow with an event (observable at or above the threshold) before its steps count, while
    nothing could be done about it, is left out, unless starts need not be quiet.

    Parameters
    ----------
    system
        The equations without actuation.
    washouts
        True states of the first washout, ``(flows, timing.washout, dimension)``: the last one is
        the state from which both the controlled and the uncontrolled flow are integrated.
    monitor
        Who raises alarms.
    actuation
        What is done about them.
    timing
        When forecasts are made and which steps count.
    threshold
        The event threshold, k_e.
    noise
        What the monitor sees is the true state plus this, ``(flows, timing.length or more,
        dimension)``: a fixed function of the flow and the step, with and without control. None: the
        monitor sees the truth.
    quiet_starts
        Whether flows with an event before the steps that count are left out.
    keep_states
        Whether to return states. Since no flow depends on the others, the states of a few flows are
        those of a second call with these flows only.

    Raises
    ------
    ValueError
        If an array has the wrong shape, or the actuation would begin before the alarm.
    FloatingPointError
        If a flow leaves the range of floating-point numbers.
    """
    check_given(system, actuation.system, washouts, timing, noise)
    batches = [
        _run_batch(
            system,
            washouts,
            monitor,
            actuation,
            timing,
            threshold,
            noise,
            quiet_starts,
            keep_states,
            rows,
        )
        for rows in flow_batches(len(washouts))
    ]
    return _concatenate(batches)


def _run_batch(
    system: DynamicalSystem,
    washouts: FloatArray,
    monitor: Monitor,
    actuation: Actuation,
    timing: Timing,
    threshold: float,
    noise: FloatArray | None,
    quiet_starts: bool,
    keep_states: bool,
    rows: IntArray,
) -> ControlledFlows:
    given = len(rows)
    uncontrolled_states = uncontrolled_flows(system, washouts[rows], timing)
    uncontrolled = observable_of(system, uncontrolled_states)
    if quiet_starts:
        quiet = quiet_flows(uncontrolled, timing, threshold)
        rows, uncontrolled = rows[quiet], uncontrolled[quiet]
        uncontrolled_states = uncontrolled_states[quiet]
    counted = slice(timing.counted_from + 1, timing.length)
    uncontrolled_energy = energy_means(system, uncontrolled_states[:, counted])
    kept_uncontrolled_states = uncontrolled_states if keep_states else None
    del uncontrolled_states

    running = _RunningFlows(system, washouts[rows], actuation, timing, threshold)
    while running.moving().size:
        due = running.due()
        if due.size:
            observed = running.last_states(due)
            if noise is not None:
                ends = running.clock[due]
                observed = observed + stretches_ending_at(noise, rows[due], ends, timing.washout)
            alarm = monitor.alarms(
                rows[due],
                running.forecast_number[due],
                np.ascontiguousarray(observed.transpose(1, 2, 0)),
            )
            running.record_alarms(due, alarm)
        running.advance()

    acting = running.acting
    actuated = actuated_samples(acting, timing)
    counted_integration_steps, switchings = counted_actuation(acting, timing)
    controlled_states = running.states[:, : timing.length]
    return ControlledFlows(
        timing=timing,
        threshold=threshold,
        rows=rows,
        left_out=given - len(rows),
        uncontrolled=uncontrolled,
        controlled=observable_of(system, controlled_states),
        actuated=actuated,
        actuated_integration_steps=counted_integration_steps,
        switchings=switchings,
        uncontrolled_energy=uncontrolled_energy,
        controlled_energy=energy_means(
            system, controlled_states[:, counted], actuation.system, actuated[:, counted]
        ),
        uncontrolled_states=kept_uncontrolled_states,
        controlled_states=controlled_states.copy() if keep_states else None,
        forecasts=running.forecasts(),
    )


class _RunningFlows:
    """Controlled flows of one batch on their way.

    All flows move together, one window at a time. A flow that stops earlier, since its next
    forecast is due, moves on from there. What it costs is one integration for all, whatever their
    clocks say. A flow whose alarm is being acted on is accompanied by a counterfactual flow: what
    would have become of it without that. It has one at most, since the next forecast is made when
    the alarm's window is over.

    Attributes
    ----------
    states
        ``(flows, steps, dimension)``; known up to each flow's clock.
    acting
        Whether the integration step from i to i + 1 time steps after step 0 is under actuation,
        ``(flows, integration steps)``.
    clock
        Step that each flow has reached, ``(flows,)``.
    forecast_number
        Number of each flow's next forecast, from 0, ``(flows,)``.
    """

    def __init__(
        self,
        system: DynamicalSystem,
        washouts: FloatArray,
        actuation: Actuation,
        timing: Timing,
        threshold: float,
    ) -> None:
        flows = len(washouts)
        stride = timing.sampling_stride
        self._system = system
        self._actuated_system = actuation.system
        self._timing = timing
        self._threshold = threshold
        self._actuation_start, self._actuation_stop = actuation.interval(timing)
        # the last step at which an alarm could still change a step that counts
        self._last_forecast = (timing.counted_until * stride - self._actuation_start - 1) // stride
        # a flow may move on for a window before it is set back to where it should have stopped
        steps = (
            max(timing.counted_until, self._last_forecast + timing.window_end)
            + timing.window_steps
            + 1
        )
        self.states = np.empty((flows, steps, system.dimension))
        self.states[:, : timing.washout] = washouts
        self.acting = np.zeros((flows, steps * stride), dtype=bool)
        self.clock = np.full(flows, timing.first_forecast, dtype=np.int64)
        self._stop = self.clock.copy()

        since_alarm = timing.window_end + timing.window_steps
        self._has_counterfactual = np.zeros(flows, dtype=bool)
        self._counterfactual_states = np.empty((flows, since_alarm + 1, system.dimension))
        self._counterfactual_acting = np.zeros((flows, since_alarm * stride), dtype=bool)

        self.forecast_number = np.zeros(flows, dtype=np.int64)
        entries = (flows, timing.most_forecasts)
        self._forecast_step = np.zeros(entries, dtype=np.int64)
        self._alarm = np.zeros(entries, dtype=bool)
        self._would_cross = np.zeros(entries, dtype=bool)
        self._would_be_under_way = np.zeros(entries, dtype=bool)
        self._reached = np.zeros(entries, dtype=bool)

    def due(self) -> IntArray:
        """Flows that are to be monitored now, each at its own clock."""
        return np.flatnonzero((self.clock == self._stop) & (self.clock <= self._last_forecast))

    def moving(self) -> IntArray:
        """Flows that have not come to their end."""
        return np.flatnonzero((self.clock < self._stop) | (self.clock <= self._last_forecast))

    def last_states(self, flows: IntArray) -> FloatArray:
        """Return the true washouts that end now, ``(flows, washout, dimension)``."""
        return stretches_ending_at(self.states, flows, self.clock[flows], self._timing.washout)

    def record_alarms(self, due: IntArray, alarm: BoolArray) -> None:
        """Note what the monitor said of the flows that were due, and act on the alarms."""
        timing = self._timing
        stride = timing.sampling_stride
        now = self.clock[due]
        self._forecast_step[due, self.forecast_number[due]] = now
        self._alarm[due, self.forecast_number[due]] = alarm
        self.forecast_number[due] += 1
        self._stop[due] = now + np.where(alarm, timing.window_end, timing.window_steps)
        for flow, step in zip(due[alarm], now[alarm], strict=True):
            self._has_counterfactual[flow] = True
            self._counterfactual_states[flow, 0] = self.states[flow, step]
            # an earlier actuation that is still on stays on for the counterfactual, too
            ahead = self.acting[flow, step * stride :][: self._counterfactual_acting.shape[1]]
            self._counterfactual_acting[flow] = False
            self._counterfactual_acting[flow, : len(ahead)] = ahead
            start, stop = step * stride + np.array([self._actuation_start, self._actuation_stop])
            self.acting[flow, start:stop] = True

    def advance(self) -> None:
        """Move all flows and their counterfactuals on, each up to its next stop at most."""
        stride, steps = self._timing.sampling_stride, self._timing.window_steps
        flows = self.moving()
        others = np.flatnonzero(self._has_counterfactual)
        now = self.clock[flows]
        since_alarm = self.clock[others] - self._alarm_step(others)
        ahead = np.arange(steps * stride)
        acting = np.concatenate(
            [
                self.acting[flows[:, np.newaxis], now[:, np.newaxis] * stride + ahead],
                self._counterfactual_acting[
                    others[:, np.newaxis], since_alarm[:, np.newaxis] * stride + ahead
                ],
            ]
        )
        samples = integrate_switched(
            (self._system, self._actuated_system),
            acting.T.view(np.uint8),
            np.concatenate(
                [self.states[flows, now], self._counterfactual_states[others, since_alarm]]
            ).T,
            self._timing.time_step,
            stride,
        )[1:].transpose(2, 0, 1)
        next_steps = np.arange(1, steps + 1)
        self.states[flows[:, np.newaxis], now[:, np.newaxis] + next_steps] = samples[: len(flows)]
        self._counterfactual_states[
            others[:, np.newaxis], since_alarm[:, np.newaxis] + next_steps
        ] = samples[len(flows) :]
        self.clock[flows] = np.minimum(now + steps, self._stop[flows])

        self._judge_alarms(others[self.clock[others] == self._stop[others]])
        # flows that are monitored no longer move on to the last step that counts
        over = (self.clock == self._stop) & (self.clock > self._last_forecast)
        self._stop[over] = np.maximum(self.clock[over], self._timing.counted_until)

    def _alarm_step(self, flows: IntArray) -> IntArray:
        steps: IntArray = self._forecast_step[flows, self.forecast_number[flows] - 1]
        return steps

    def _judge_alarms(self, flows: IntArray) -> None:
        """Note what came of alarms whose windows are over, and what would have come otherwise."""
        timing = self._timing
        entry = flows, self.forecast_number[flows] - 1
        otherwise = self._observable(self._counterfactual_states[flows, : timing.window_end + 1])
        self._would_cross[entry] = crosses_in_window(
            otherwise[1:], timing.window_start, timing.window_end, self._threshold
        )
        self._would_be_under_way[entry] = otherwise[timing.window_start] >= self._threshold

        ends = self.clock[flows]
        since_alarm = stretches_ending_at(self.states, flows, ends, timing.window_end + 1)
        observable = self._observable(since_alarm)
        above = observable >= self._threshold
        upward = upward_crossings(observable, self._threshold, axis=0)
        # a step under actuation in part is one that actuation could have changed
        first = self._actuation_start // timing.sampling_stride
        before_window = np.any(upward[first + 1 : timing.window_start + 1], axis=0)
        in_window = np.any(above[timing.window_start :], axis=0)
        self._reached[entry] = before_window | in_window
        self._has_counterfactual[flows] = False

    def _observable(self, states: FloatArray) -> FloatArray:
        """Observable of states with the components last, time first: ``(steps, flows)``."""
        return observable_of(self._system, states).T

    def forecasts(self) -> Forecasts:
        """All forecasts, flow by flow in the order of time."""
        made = np.arange(self._alarm.shape[1]) < self.forecast_number[:, np.newaxis]
        return Forecasts(
            flow=np.nonzero(made)[0],
            step=self._forecast_step[made],
            alarm=self._alarm[made],
            would_cross=self._would_cross[made],
            would_be_under_way=self._would_be_under_way[made],
            reached=self._reached[made],
        )


def _concatenate_forecasts(parts: list[Forecasts]) -> Forecasts:
    return Forecasts(
        flow=np.concatenate([part.flow for part in parts]),
        step=np.concatenate([part.step for part in parts]),
        alarm=np.concatenate([part.alarm for part in parts]),
        would_cross=np.concatenate([part.would_cross for part in parts]),
        would_be_under_way=np.concatenate([part.would_be_under_way for part in parts]),
        reached=np.concatenate([part.reached for part in parts]),
    )


def _concatenate(batches: list[ControlledFlows]) -> ControlledFlows:
    first = np.cumsum([0, *(len(batch) for batch in batches)])
    renumbered = [
        Forecasts(
            flow=batch.forecasts.flow + offset,
            step=batch.forecasts.step,
            alarm=batch.forecasts.alarm,
            would_cross=batch.forecasts.would_cross,
            would_be_under_way=batch.forecasts.would_be_under_way,
            reached=batch.forecasts.reached,
        )
        for batch, offset in zip(batches, first[:-1], strict=True)
    ]
    return ControlledFlows(
        **concatenated(batches),
        timing=batches[0].timing,
        forecasts=_concatenate_forecasts(renumbered),
    )
