"""Flows under prediction-triggered control, many side by side, each beside its uncontrolled twin.

Source: section "Control of extreme events" of the paper.
"""

from dataclasses import dataclass

import numpy as np

from burstcast.control.actuation import Actuation
from burstcast.control.monitor import BoolArray, IntArray, Monitor, crosses_in_window
from burstcast.control.timing import Timing
from burstcast.systems.base import DynamicalSystem, FloatArray
from burstcast.systems.integration import integrate

FLOWS_PER_BATCH = 512
"""Flows that advance side by side: bounds the memory, changes no result."""


@dataclass(frozen=True)
class Forecasts:
    """All forecasts that were made, flow by flow in the order of time.

    Attributes
    ----------
    flow
        Position of each forecast's flow among the followed ones, ``(forecasts,)``.
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
        Which of the given flows were followed, ``(flows,)``.
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


def follow(
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

    Each flow has its own clock. At each of its forecasts the monitor sees the last observed states.
    On an alarm the flow is integrated on under the actuation's equations over the actuation's
    interval and under its own equations before and after it; that is the new truth. Where an
    actuation is still on at the next alarm, it stays on until the later of the two ends.

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
        _follow_batch(
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


def _follow_batch(
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

    running = _RunningFlows(system, washouts[rows], actuation, timing)
    forecasts = [_no_forecasts()]
    occasions = np.zeros(len(rows), dtype=np.int64)
    while (due := running.due()).size:
        observed = running.last_states(due)
        if noise is not None:
            observed = observed + _windows_ending_at(noise, rows[due], running.clock[due], timing)
        alarm = monitor.alarms(
            rows[due], occasions[due], np.ascontiguousarray(observed.transpose(1, 2, 0))
        )
        occasions[due] += 1
        forecasts.append(_act(running, due, alarm, threshold))
    running.finish()

    return ControlledFlows(
        timing=timing,
        threshold=threshold,
        rows=rows,
        left_out=given - len(rows),
        uncontrolled=uncontrolled,
        controlled=_observable(system, running.states[:, : timing.length]),
        actuated=running.actuated_samples(),
        actuated_integration_steps=running.actuated_integration_steps(),
        forecasts=_in_order(_concatenate_forecasts(forecasts)),
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


def _act(running: "_RunningFlows", due: IntArray, alarm: BoolArray, threshold: float) -> Forecasts:
    """Move the due flows on to their next forecasts, acting on the alarms."""
    timing = running.timing
    step = running.clock[due]
    alarmed = due[alarm]
    outcome = {
        name: np.zeros(len(due), dtype=bool)
        for name in ("would_cross", "would_be_under_way", "reached")
    }
    if alarmed.size:
        # had the alarm not been acted on; an earlier actuation that is still on stays on
        otherwise = running.observable(running.continuation(alarmed, timing.window_end))
        outcome["would_cross"][alarm] = crosses_in_window(otherwise, timing, threshold)
        outcome["would_be_under_way"][alarm] = otherwise[timing.window_start - 1] >= threshold
        running.schedule_actuation(alarmed)
    running.advance(due, timing.window_steps)
    if alarmed.size:
        running.advance(alarmed, timing.window_end - timing.window_steps)
        outcome["reached"][alarm] = _reached(running, alarmed, threshold)
    return Forecasts(flow=due, step=step, alarm=alarm, **outcome)


def _reached(running: "_RunningFlows", alarmed: IntArray, threshold: float) -> BoolArray:
    """Whether flows at the end of an alarm's window have had an event despite the actuation."""
    timing = running.timing
    steps = running.clock[alarmed, np.newaxis] + np.arange(-timing.window_end, 1)
    since_alarm = running.states[alarmed[:, np.newaxis], steps].transpose(1, 2, 0)
    above = running.observable(since_alarm) >= threshold
    upward = above[1:] & ~above[:-1]  # entry i: between i and i + 1 steps after the alarm
    # a step under actuation in part is one that actuation could have changed
    first = running.actuation_start // timing.sampling_stride
    before_window = np.any(upward[first : timing.window_start], axis=0)
    in_window = np.any(above[timing.window_start :], axis=0)
    reached: BoolArray = np.logical_or(before_window, in_window)
    return reached


class _RunningFlows:
    """Controlled flows of one batch: their states so far, their clocks, their actuation.

    Attributes
    ----------
    states
        ``(flows, steps, dimension)``; known up to each flow's clock.
    clock
        Step that each flow has reached, ``(flows,)``.
    """

    def __init__(
        self, system: DynamicalSystem, washouts: FloatArray, actuation: Actuation, timing: Timing
    ) -> None:
        flows = len(washouts)
        self.timing = timing
        self._system = system
        self._actuated_system = actuation.system
        self.actuation_start, self._actuation_stop = actuation.interval(timing)
        # the last step at which an actuation of these flows could still begin among the steps that
        # count
        self._last_forecast = (
            timing.counted_until * timing.sampling_stride - self.actuation_start - 1
        ) // timing.sampling_stride
        steps = max(timing.counted_until, self._last_forecast + timing.window_end) + 1
        self.states = np.empty((flows, steps, system.dimension))
        self.states[:, : timing.washout] = washouts
        self.clock = np.full(flows, timing.first_forecast, dtype=np.int64)
        # entry i: whether the integration step from i to i + 1 time steps after step 0 is actuated
        self._acting = np.zeros((flows, steps * timing.sampling_stride), dtype=bool)

    def due(self) -> IntArray:
        """Flows that are to be monitored, each at its own clock."""
        return np.flatnonzero(self.clock <= self._last_forecast)

    def observable(self, states: FloatArray) -> FloatArray:
        """Observable of states with the components second, ``(steps, dimension, flows)``."""
        return self._system.observable(np.ascontiguousarray(states.transpose(1, 0, 2)))

    def last_states(self, flows: IntArray) -> FloatArray:
        """Return the true washouts that end now, ``(flows, washout, dimension)``."""
        return _windows_ending_at(self.states, flows, self.clock[flows], self.timing)

    def schedule_actuation(self, flows: IntArray) -> None:
        """Act on alarms that are raised now."""
        now = self.clock[flows] * self.timing.sampling_stride
        for flow, step in zip(flows, now, strict=True):
            self._acting[flow, step + self.actuation_start : step + self._actuation_stop] = True

    def continuation(self, flows: IntArray, steps: int) -> FloatArray:
        """Next samples under the actuation scheduled so far, ``(steps, dimension, flows)``."""
        stride = self.timing.sampling_stride
        now = self.clock[flows]
        columns = now[:, np.newaxis] * stride + np.arange(steps * stride)
        return _integrate_with_actuation(
            self._system,
            self._actuated_system,
            self.states[flows, now].T,
            self._acting[flows[:, np.newaxis], columns],
            self.timing.time_step,
            stride,
        )

    def advance(self, flows: IntArray, steps: int) -> None:
        """Move flows and their clocks on."""
        columns = self.clock[flows, np.newaxis] + np.arange(1, steps + 1)
        samples = self.continuation(flows, steps)
        self.states[flows[:, np.newaxis], columns] = samples.transpose(2, 0, 1)
        self.clock[flows] += steps

    def finish(self) -> None:
        """Move every flow on to the last step that counts."""
        missing = self.timing.counted_until - self.clock
        for steps in np.unique(missing[missing > 0]):
            self.advance(np.flatnonzero(missing == steps), int(steps))

    def actuated_samples(self) -> BoolArray:
        """Whether the flow came to each step under actuation, ``(flows, timing.length)``."""
        stride = self.timing.sampling_stride
        actuated = np.zeros((len(self.clock), self.timing.length), dtype=bool)
        actuated[:, 1:] = self._acting[:, stride - 1 :: stride][:, : self.timing.length - 1]
        return actuated

    def actuated_integration_steps(self) -> IntArray:
        """Integration steps under actuation among those that count, ``(flows,)``."""
        stride = self.timing.sampling_stride
        counted = slice(self.timing.counted_from * stride, self.timing.counted_until * stride)
        steps: IntArray = np.sum(self._acting[:, counted], axis=1, dtype=np.int64)
        return steps


def _integrate_with_actuation(
    system: DynamicalSystem,
    actuated_system: DynamicalSystem,
    state: FloatArray,
    acting: BoolArray,
    time_step: float,
    stride: int,
) -> FloatArray:
    """Integrate flows, each under its own actuation ``(flows, integration steps)``.

    Returns the samples after the initial states, ``(integration steps // stride, dimension,
    flows)``.
    """
    steps = acting.shape[1]
    samples = np.empty((steps // stride, *state.shape))
    changes = np.flatnonzero((acting[:, 1:] != acting[:, :-1]).any(axis=0)) + 1
    current = np.ascontiguousarray(state)
    # between two changes each flow obeys one set of equations
    for start, stop in zip([0, *changes], [*changes, steps], strict=True):
        first_sample = start // stride  # of the samples after `start`
        on_grid = np.arange(first_sample, stop // stride)
        last = np.empty_like(current)
        for equations, members in (
            (system, np.flatnonzero(~acting[:, start])),
            (actuated_system, np.flatnonzero(acting[:, start])),
        ):
            if members.size == 0:
                continue
            # actuation may begin and end between samples: keep every state
            piece = integrate(equations, current[:, members], time_step, int(stop - start))
            samples[np.ix_(on_grid, np.arange(len(state)), members)] = piece[
                (on_grid + 1) * stride - start
            ]
            last[:, members] = piece[-1]
        current = last
    return samples


def _windows_ending_at(
    series: FloatArray, rows: IntArray, ends: IntArray, timing: Timing
) -> FloatArray:
    """Washouts that end at each row's own step, ``(rows, washout, dimension)``."""
    steps = ends[:, np.newaxis] + np.arange(1 - timing.washout, 1)
    return np.asarray(series[rows[:, np.newaxis], steps])


def _observable(system: DynamicalSystem, states: FloatArray) -> FloatArray:
    """Observable of states with the components last, ``(flows, steps)``."""
    return system.observable(np.ascontiguousarray(states.transpose(2, 0, 1)))


def _no_forecasts() -> Forecasts:
    none = np.zeros(0, dtype=np.int64)
    never = np.zeros(0, dtype=bool)
    return Forecasts(none, none, never, never, never, never)


def _concatenate_forecasts(parts: list[Forecasts]) -> Forecasts:
    return Forecasts(
        flow=np.concatenate([part.flow for part in parts]),
        step=np.concatenate([part.step for part in parts]),
        alarm=np.concatenate([part.alarm for part in parts]),
        would_cross=np.concatenate([part.would_cross for part in parts]),
        would_be_under_way=np.concatenate([part.would_be_under_way for part in parts]),
        reached=np.concatenate([part.reached for part in parts]),
    )


def _in_order(forecasts: Forecasts) -> Forecasts:
    order = np.lexsort((forecasts.step, forecasts.flow))
    return Forecasts(
        flow=forecasts.flow[order],
        step=forecasts.step[order],
        alarm=forecasts.alarm[order],
        would_cross=forecasts.would_cross[order],
        would_be_under_way=forecasts.would_be_under_way[order],
        reached=forecasts.reached[order],
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
