"""Flows under prediction-triggered control, many side by side, each beside its uncontrolled twin.

Source: section "Control of extreme events" of the paper.
"""

from dataclasses import dataclass

import numpy as np

from burstcast.arrays import BoolArray, FloatArray, IntArray
from burstcast.control.actuation import Actuation
from burstcast.control.monitors.base import Monitor
from burstcast.control.timing import Timing
from burstcast.events import upward_crossings
from burstcast.forecast.windows import crosses_in_window
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.integration import integrate, integrate_switched

FLOWS_PER_BATCH = 1024
"""Flows that advance side by side: bounds the memory, changes no result."""


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
class ControlledFlows:
    """Flows with and without control, from the same states over the same steps.

    Attributes
    ----------
    timing
        Which steps count.
    threshold
        The event threshold, k_e.
    rows
        Which of the given flows these are, ``(flows,)``.
    left_out
        How many of the given flows were not, since they had an event at the start.
    uncontrolled, controlled
        Observable, ``(flows, timing.length)``.
    actuated
        Whether the controlled flow came to each step under actuation, ``(flows, timing.length)``.
    actuated_integration_steps
        Integration steps under actuation among those that count, ``(flows,)``.
    forecasts
        What the monitor said, and what came of it. The last windows may reach beyond the last step
        of the flows: forecasts are made as long as an actuation could still begin before it.
    uncontrolled_states, controlled_states
        States, ``(flows, timing.length, dimension)``; None unless asked for.
    """

    timing: Timing
    threshold: float
    rows: IntArray
    left_out: int
    uncontrolled: FloatArray
    controlled: FloatArray
    actuated: BoolArray
    actuated_integration_steps: IntArray
    forecasts: Forecasts
    uncontrolled_states: FloatArray | None
    controlled_states: FloatArray | None

    def __len__(self) -> int:
        """Return the number of flows."""
        return len(self.rows)


def run_controlled_flows(
    system: DynamicalSystem,
    washouts: FloatArray,
    monitor: Monitor,
    actuation: Actuation,
    timing: Timing,
    threshold: float,
    *,
    noise: FloatArray | None = None,
    keep_states: bool = False,
) -> ControlledFlows:
    """Follow flows under control, and the same flows without it.

    Each flow has its own clock; all move together. At each of its forecasts the monitor sees the
    last observed states. On an alarm the flow is integrated on under the actuation's equations over
    the actuation's interval and under its own equations before and after it; that is the new truth.
    Where an actuation is still on at the next alarm, it stays on until the later of the two ends.

    A flow with an event (observable at or above the threshold) up to the end of its first window,
    while nothing could be done about it, is left out.

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
    flows = len(washouts)
    if washouts.shape != (flows, timing.washout, system.dimension):
        raise ValueError(
            f"the washouts must have the shape (flows, {timing.washout}, {system.dimension}), "
            f"not {washouts.shape}"
        )
    if noise is not None and (
        noise.ndim != 3
        or (noise.shape[0], noise.shape[2]) != (flows, system.dimension)
        or noise.shape[1] < timing.length
    ):
        raise ValueError(
            f"the noise must have the shape ({flows}, {timing.length} or more, "
            f"{system.dimension}), not {noise.shape}"
        )
    if actuation.system.dimension != system.dimension:
        raise ValueError("the equations under actuation have another dimension")
    batches = [
        _run_batch(
            system, washouts, monitor, actuation, timing, threshold, noise, keep_states, rows
        )
        for rows in _batches(flows)
    ]
    return _concatenate(batches)


def _batches(flows: int) -> list[IntArray]:
    # no flows at all are one empty batch
    return [
        np.arange(start, min(start + FLOWS_PER_BATCH, flows))
        for start in range(0, max(flows, 1), FLOWS_PER_BATCH)
    ]


def _run_batch(
    system: DynamicalSystem,
    washouts: FloatArray,
    monitor: Monitor,
    actuation: Actuation,
    timing: Timing,
    threshold: float,
    noise: FloatArray | None,
    keep_states: bool,
    rows: IntArray,
) -> ControlledFlows:
    given = len(rows)
    uncontrolled_states = _uncontrolled(system, washouts[rows], timing)
    uncontrolled = _observable(system, uncontrolled_states)
    quiet = (uncontrolled[:, : timing.counted_from + 1] < threshold).all(axis=1)
    rows = rows[quiet]
    uncontrolled = uncontrolled[quiet]
    kept_uncontrolled_states = uncontrolled_states[quiet] if keep_states else None
    del uncontrolled_states

    running = _RunningFlows(system, washouts[rows], actuation, timing, threshold)
    while running.moving().size:
        due = running.due()
        if due.size:
            observed = running.last_states(due)
            if noise is not None:
                ends = running.clock[due]
                observed = observed + _stretches_ending_at(noise, rows[due], ends, timing.washout)
            alarm = monitor.alarms(
                rows[due],
                running.forecast_number[due],
                np.ascontiguousarray(observed.transpose(1, 2, 0)),
            )
            running.record_alarms(due, alarm)
        running.advance()

    return ControlledFlows(
        timing=timing,
        threshold=threshold,
        rows=rows,
        left_out=given - len(rows),
        uncontrolled=uncontrolled,
        controlled=_observable(system, running.states[:, : timing.length]),
        actuated=running.actuated_samples(),
        actuated_integration_steps=running.actuated_integration_steps(),
        forecasts=running.forecasts(),
        uncontrolled_states=kept_uncontrolled_states,
        controlled_states=running.states[:, : timing.length].copy() if keep_states else None,
    )


def _uncontrolled(system: DynamicalSystem, washouts: FloatArray, timing: Timing) -> FloatArray:
    steps = timing.counted_until - timing.first_forecast
    samples = integrate(
        system,
        np.ascontiguousarray(washouts[:, -1].T),
        timing.time_step,
        steps * timing.sampling_stride,
        stride=timing.sampling_stride,
    )
    return np.concatenate([washouts[:, :-1], samples.transpose(2, 0, 1)], axis=1)


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
        # entry i: whether the integration step from i to i + 1 time steps after step 0 is actuated
        self._acting = np.zeros((flows, steps * stride), dtype=bool)
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
        return _stretches_ending_at(self.states, flows, self.clock[flows], self._timing.washout)

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
            ahead = self._acting[flow, step * stride :][: self._counterfactual_acting.shape[1]]
            self._counterfactual_acting[flow] = False
            self._counterfactual_acting[flow, : len(ahead)] = ahead
            start, stop = step * stride + np.array([self._actuation_start, self._actuation_stop])
            self._acting[flow, start:stop] = True

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
                self._acting[flows[:, np.newaxis], now[:, np.newaxis] * stride + ahead],
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
        since_alarm = _stretches_ending_at(self.states, flows, ends, timing.window_end + 1)
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
        return _observable(self._system, states).T

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

    def actuated_samples(self) -> BoolArray:
        """Whether the flow came to each step under actuation, ``(flows, timing.length)``."""
        stride = self._timing.sampling_stride
        actuated = np.zeros((len(self.clock), self._timing.length), dtype=bool)
        actuated[:, 1:] = self._acting[:, stride - 1 :: stride][:, : self._timing.length - 1]
        return actuated

    def actuated_integration_steps(self) -> IntArray:
        """Integration steps under actuation among those that count, ``(flows,)``."""
        timing = self._timing
        counted = slice(
            timing.counted_from * timing.sampling_stride,
            timing.counted_until * timing.sampling_stride,
        )
        steps: IntArray = np.sum(self._acting[:, counted], axis=1, dtype=np.int64)
        return steps


def _stretches_ending_at(
    series: FloatArray, rows: IntArray, ends: IntArray, length: int
) -> FloatArray:
    """Stretches of series that end at each row's own step, ``(rows, length, dimension)``."""
    steps = ends[:, np.newaxis] + np.arange(1 - length, 1)
    return np.asarray(series[rows[:, np.newaxis], steps])


def _observable(system: DynamicalSystem, states: FloatArray) -> FloatArray:
    """Observable of states with the components last, ``(flows, steps)``."""
    return system.observable(np.ascontiguousarray(states.transpose(2, 0, 1)))


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
        timing=batches[0].timing,
        threshold=batches[0].threshold,
        rows=np.concatenate([batch.rows for batch in batches]),
        left_out=sum(batch.left_out for batch in batches),
        uncontrolled=np.concatenate([batch.uncontrolled for batch in batches]),
        controlled=np.concatenate([batch.controlled for batch in batches]),
        actuated=np.concatenate([batch.actuated for batch in batches]),
        actuated_integration_steps=np.concatenate(
            [batch.actuated_integration_steps for batch in batches]
        ),
        forecasts=_concatenate_forecasts(renumbered),
        uncontrolled_states=_concatenate_states([batch.uncontrolled_states for batch in batches]),
        controlled_states=_concatenate_states([batch.controlled_states for batch in batches]),
    )


def _concatenate_states(parts: list[FloatArray | None]) -> FloatArray | None:
    kept = [part for part in parts if part is not None]
    return np.concatenate(kept) if kept else None
