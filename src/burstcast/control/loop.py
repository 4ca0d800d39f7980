"""The control loop: it advances flows and applies the decisions of a policy.

All flows of a batch move together, each on its own clock. At each look the policy is given the last
observed states of a flow; an alarm triggers the actuation for an interval after the look. `Timing`
sets the times of the looks and the length of that interval.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from burstcast.base.arrays import BoolArray, ByteArray, FloatArray, IntArray
from burstcast.control.energy import ActuationCost, actuation_cost, energy_means
from burstcast.control.experiment import ControlExperiment
from burstcast.control.policy import WITHOUT_FORECAST, Look, Policy
from burstcast.control.timing import Timing
from burstcast.data.encoders.channels import EncodedFlow
from burstcast.systems.base import DynamicalSystem, EnergyBudget
from burstcast.systems.integration import LostTrajectoryError, integrate, integrate_switched

FLOWS_PER_BATCH = 1024
"""Flows that are simulated side by side: bounds the memory, changes no result."""

Entry = TypeVar("Entry", bound=np.generic)


@dataclass(frozen=True)
class Looks:
    """All looks at flows, flow by flow in the order of time, ``(looks,)`` each."""

    flow: IntArray  #: position of the flow among the simulated flows
    step: IntArray
    alarm: BoolArray  #: whether the look triggered the actuation
    without_forecast: BoolArray  #: whether no valid forecast stands behind the decision
    #: assessments of the looks by the strategy, by name
    judged: Mapping[str, BoolArray]


@dataclass(frozen=True)
class ControlledFlows:
    """Flows with and without control, from the same states over the same steps."""

    timing: Timing
    threshold: float  #: the event threshold, k_e
    left_out: int  #: number of flows left out, for an event before the first counted step
    rows: IntArray  #: rows of the simulated flows among the given ones, ``(flows,)``
    #: uncontrolled, controlled: observable, ``(flows, timing.length)``
    uncontrolled: FloatArray
    controlled: FloatArray
    #: whether the controlled flow came to each step under actuation, ``(flows, timing.length)``
    actuated: BoolArray
    #: integration steps under actuation among the counted ones, ``(flows,)``
    actuated_integration_steps: IntArray
    #: number of times that the actuation was switched on within the counted integration steps,
    #: ``(flows,)``; an actuation that is on at the first counted step counts
    switchings: IntArray
    #: uncontrolled_energy, controlled_energy: means over the steps that count, ``(flows,)``; None
    #: for a system without an energy budget
    uncontrolled_energy: EnergyBudget | None
    controlled_energy: EnergyBudget | None
    #: uncontrolled_states, controlled_states: ``(flows, timing.length, dimension)``; None unless
    #: states are requested
    uncontrolled_states: FloatArray | None
    controlled_states: FloatArray | None
    looks: Looks
    #: step at which the controlled flow is first out of the range of floating-point numbers, from
    #: which on its states are NaN; -1: it stays finite. ``(flows,)``
    escape_step: IntArray
    cost: ActuationCost | None  #: None unless requested and the system has a right-hand side

    def __len__(self) -> int:
        """Return the number of flows."""
        return len(self.rows)


class RunningFlows:
    """Controlled flows of one batch while they are simulated.

    A flow whose next look is due earlier than others' continues from there: later states are
    overwritten.
    """

    def __init__(self, experiment: ControlExperiment, timing: Timing, rows: IntArray) -> None:
        self.experiment, self.timing, self.rows = experiment, timing, rows
        self._stride, (self._shortest, longest) = timing.schedule.sampling_stride, timing.pauses
        steps = max(timing.counted_until, timing.last_look + longest) + self._shortest + 1
        #: ``(flows, steps, dimension)``; known up to each flow's clock
        self.states = np.empty((len(rows), steps, experiment.system.dimension))
        self.states[:, : timing.schedule.washout] = experiment.washouts[rows]
        #: number of the actuation that each integration step is under, ``(flows, steps)``
        self.acting: ByteArray = np.zeros((len(rows), steps * self._stride), dtype=np.uint8)
        #: step that each flow has reached, and the step of its next look
        self.clock = np.full(len(rows), timing.first_look, dtype=np.int64)
        self._stop = self.clock.copy()
        self._leave()
        #: step at which each flow is first not finite; -1: none
        self.escape_step = np.full(len(rows), -1, dtype=np.int64)
        self._number = np.zeros(len(rows), dtype=np.int64)
        none = np.empty(0, dtype=np.int64)
        nobody = none != 0
        self._looks: list[tuple[IntArray, IntArray, BoolArray, BoolArray]] = [
            (none, none, nobody, nobody)
        ]

    def run(self, policy: Policy, noise: FloatArray | None) -> None:
        """Simulate the flows to their ends.

        A flow that leaves the range of floating-point numbers under actuation ends there
        (``escape_step``). Raises FloatingPointError if one does so without any, or if all do.
        """
        last = self.timing.last_look
        while (moving := np.flatnonzero((self.clock < self._stop) | (self.clock <= last))).size:
            due = np.flatnonzero((self.clock == self._stop) & (self.clock <= last))
            if due.size:
                self._act(due, np.asarray(policy(self._look(due, noise))).astype(np.uint8))
            self._advance(moving)
            self._end_escaped(moving)

    def looks(self) -> Looks:
        """All looks so far, without assessments."""
        flow, step, alarm, without = map(np.concatenate, zip(*self._looks, strict=True))
        order = np.lexsort((step, flow))
        return Looks(flow[order], step[order], alarm[order], without[order], {})

    def _look(self, due: IntArray, noise: FloatArray | None) -> Look:
        """Observe flows up to their clocks."""
        washout, now, sensor = self.timing.schedule.washout, self.clock[due], self.experiment.sensor
        seen = ending_at(self.states, due, now, washout)
        if sensor is not None:
            seen = np.moveaxis(sensor(np.moveaxis(seen, -1, 0)), 0, -1)
        if noise is not None:
            seen = seen + ending_at(noise, self.rows[due], now, washout)
        observed = np.ascontiguousarray(seen.transpose(1, 2, 0))
        if isinstance(sensor, EncodedFlow):
            encoded = sensor.encode(np.ascontiguousarray(observed.transpose(1, 0, 2)))
            observed = np.ascontiguousarray(encoded.transpose(1, 0, 2))
        # actuation over the washout, and until an alarm takes effect
        pending = self.timing.effect[0] // self._stride
        last, steps = (now + pending) * self._stride - 1, washout - 1 + pending
        behind = ending_at(self.acting, due, last, steps * self._stride)
        acting = np.asarray(behind[:, self._stride - 1 :: self._stride].T)
        return Look(self.rows[due], self._number[due], observed, acting)

    def _act(self, due: IntArray, decided: ByteArray) -> None:
        """Trigger the chosen actuation and set the time of the next look."""
        without, decided = decided >= WITHOUT_FORECAST, decided % WITHOUT_FORECAST
        now, alarm, (start, stop) = self.clock[due], decided != 0, self.timing.effect
        self._looks.append((due, now, alarm, without))
        self._number[due] += 1
        self._stop[due] = now + np.where(alarm, *self.timing.pauses[::-1])
        for flow, step, number in zip(
            due[alarm], now[alarm] * self._stride, decided[alarm], strict=True
        ):
            self.acting[flow, step + start : step + stop] = number

    def _advance(self, flows: IntArray) -> None:
        """Move flows on by the shortest pause, each up to its next stop at most."""
        now, ahead = self.clock[flows], np.arange(1, self._shortest + 1)
        samples = self.integrated(flows, now, self._shortest)[1:]
        self.states[flows[:, np.newaxis], now[:, np.newaxis] + ahead] = samples.transpose(2, 0, 1)
        self.clock[flows] = np.minimum(now + self._shortest, self._stop[flows])
        self._leave()

    def _leave(self) -> None:
        """Let flows after their last look advance to the last counted step."""
        over = (self.clock == self._stop) & (self.clock > self.timing.last_look)
        self._stop[over] = np.maximum(self.clock[over], self.timing.counted_until)

    def _end_escaped(self, moved: IntArray) -> None:
        """End flows whose last states are not finite."""
        last = self.states[moved, self.clock[moved]]
        lost = moved[~np.isfinite(last).all(axis=1)]
        if not lost.size:
            return
        for flow in lost.tolist():
            if not self.acting[flow, : self.clock[flow] * self._stride].any():
                raise LostTrajectoryError(flow, self.timing.schedule.time_step)
            finite = np.isfinite(self.states[flow, : self.clock[flow] + 1]).all(axis=1)
            self.escape_step[flow] = int(np.argmin(finite))
            self.states[flow, self.escape_step[flow] :] = np.nan
        self.clock[lost] = self._stop[lost] = self._last_step
        if (self.escape_step >= 0).all():
            raise FloatingPointError(self._lost_under_actuation(int(lost[0])))

    @property
    def _last_step(self) -> int:
        """Step at which a flow is over."""
        return max(self.timing.last_look + 1, self.timing.counted_until)

    def integrated(
        self, flows: IntArray, now: IntArray, steps: int, acting: ByteArray | None = None
    ) -> FloatArray:
        """States of flows from their steps ``now`` on, ``(steps + 1, dimension, flows)``.

        ``acting``: The actuation over these steps, ``(flows, integration steps)``; by default the
        actuation triggered so far.
        """
        if acting is None:
            acting = self.acting_from(flows, now, steps)
        state, schedule = self.states[flows, now].T, self.timing.schedule
        return integrate_switched(
            self.experiment.systems,
            acting.T,
            state,
            schedule.time_step,
            self._stride,
            may_diverge=True,
        )

    def acting_from(self, flows: IntArray, now: IntArray, steps: int) -> ByteArray:
        """Actuation triggered so far over the steps from ``now`` on."""
        ahead = now[:, np.newaxis] * self._stride + np.arange(steps * self._stride)
        return np.asarray(self.acting[flows[:, np.newaxis], ahead])

    def _lost_under_actuation(self, flow: int) -> str:
        """Describe how actuation takes flows out of the range of numbers; ``flow``: the last."""
        schedule = self.timing.schedule
        end = int(self.escape_step[flow]) * self._stride
        acted = np.flatnonzero(self.acting[flow, :end])
        since, under = (steps * schedule.time_step for steps in (end - acted[0], acted.size))
        return (
            f"all {len(self.rows)} controlled flows left the range of floating-point numbers under "
            f"actuation, flow {self.rows[flow]} at most {since:g} time units after it was first "
            f"actuated, {under:g} of them under actuation. Either the actuated equations have no "
            "bounded solution: take a weaker actuation (smaller changes of actuation.parameters, a "
            "smaller actuation.force, or a smaller strength of the block of control.strategies); "
            f"or they need a shorter ensemble.time_step than {schedule.time_step:g}"
        )

    def actuation(self) -> ByteArray:
        """Actuation under which flows came to each step, ``(flows, timing.length)``."""
        into_step = self.acting[:, self._stride - 1 :: self._stride]
        return np.pad(into_step[:, : self.timing.length - 1], ((0, 0), (1, 0)))

    def counted_actuation(self) -> tuple[IntArray, IntArray]:
        """Integration steps under actuation that count, and how often it was switched on."""
        first, stop = self.timing.counted_from, self.timing.counted_until
        acting = self.acting[:, first * self._stride : stop * self._stride] != 0
        switched_on = acting.copy()
        switched_on[:, 1:] &= ~acting[:, :-1]
        return acting.sum(axis=1, dtype=np.int64), switched_on.sum(axis=1, dtype=np.int64)


Judge = Callable[[RunningFlows, Looks], Mapping[str, BoolArray]]
"""Assessments of all looks at finished flows by a strategy, by name, ``(looks,)`` each."""


def simulate(
    experiment: ControlExperiment,
    timing: Timing,
    policy: Policy,
    *,
    judge: Judge | None = None,
    noise: FloatArray | None = None,
    keep_states: bool = False,
    costs: bool = False,
) -> ControlledFlows:
    """Simulate flows with and without control from identical states.

    ``noise``: Observation noise, ``(flows, timing.length or more, observed components)``, which is
    added to the true state or to the output of the sensor. It depends on flow and step alone, so
    that runs with and without control share it. None: no noise. ``keep_states``: Whether to return
    states. Since no flow depends on the others, a second call with a few flows only returns their
    states. ``costs``: Whether to compute the cost of the actuation.
    """
    _check_given(experiment, timing, noise)
    systems, counted, given = experiment.systems, timing.counted, len(experiment.washouts)
    parts: list[dict[str, Any]] = []
    simulated = 0
    # no flows at all are one empty batch
    for first in range(0, max(given, 1), FLOWS_PER_BATCH):
        rows = np.arange(first, min(first + FLOWS_PER_BATCH, given))
        free = _uncontrolled_flows(experiment, timing, rows)
        observable = observable_of(experiment.system, free)
        if experiment.quiet_starts:
            before = observable[:, : timing.counted_from + 1]
            quiet = (before < experiment.threshold).all(axis=1)
            rows, observable, free = rows[quiet], observable[quiet], free[quiet]
        nothing = np.zeros((len(rows), timing.span), dtype=np.uint8)
        part = {
            "rows": rows,
            "uncontrolled": observable,
            "uncontrolled_energy": energy_means(systems[:1], free[:, counted], nothing),
            "uncontrolled_states": free if keep_states else None,
        }
        del free
        flows = RunningFlows(experiment, timing, rows)
        flows.run(policy, noise)
        looks = flows.looks()
        judged = judge(flows, looks) if judge else {}
        states, actuation = flows.states[:, : timing.length], flows.actuation()
        acting_steps, switchings = flows.counted_actuation()
        under = states[:, counted], actuation[:, counted]
        # a flow is very large before it is not finite
        with np.errstate(over="ignore", invalid="ignore"):
            of_states = {
                "controlled": observable_of(experiment.system, states),
                "controlled_energy": energy_means(systems, *under),
                "cost": actuation_cost(systems, *under) if costs else None,
            }
        parts.append(
            {
                **part,
                **of_states,
                "actuated": actuation != 0,
                "actuated_integration_steps": acting_steps,
                "switchings": switchings,
                "controlled_states": states.copy() if keep_states else None,
                "looks": replace(looks, flow=simulated + looks.flow, judged=judged),
                "escape_step": flows.escape_step,
            }
        )
        simulated += len(rows)
    return ControlledFlows(
        timing=timing,
        threshold=experiment.threshold,
        left_out=given - simulated,
        **{name: _joined([part[name] for part in parts]) for name in parts[0]},
    )


def _joined(parts: Sequence[Any]) -> Any:
    """Join arrays, or what holds arrays, along their first axis; None where there are none."""
    first = parts[0]
    if isinstance(first, Mapping):
        return {name: _joined([part[name] for part in parts]) for name in first}
    if isinstance(first, EnergyBudget):
        return EnergyBudget(*map(_joined, zip(*parts, strict=True)))
    if is_dataclass(first) and not isinstance(first, type):
        names = [entry.name for entry in fields(first)]
        return replace(
            first, **{name: _joined([getattr(part, name) for part in parts]) for name in names}
        )
    return None if first is None else np.concatenate(parts)


def ending_at(
    series: npt.NDArray[Entry], rows: IntArray, ends: IntArray, length: int
) -> npt.NDArray[Entry]:
    """Sections of series that end at a step for each row, ``(rows, length, ...)``."""
    steps = ends[:, np.newaxis] + np.arange(1 - length, 1)
    return np.asarray(series[rows[:, np.newaxis], steps])


def observable_of(system: DynamicalSystem, states: FloatArray) -> FloatArray:
    """Observable of states with the components last, ``(flows, steps)``."""
    return system.observable(np.ascontiguousarray(states.transpose(2, 0, 1)))


def _uncontrolled_flows(
    experiment: ControlExperiment, timing: Timing, rows: IntArray
) -> FloatArray:
    """Flows without control, ``(flows, timing.length, dimension)``, washouts included."""
    washouts, stride = experiment.washouts[rows], timing.schedule.sampling_stride
    samples = integrate(
        experiment.system,
        np.ascontiguousarray(washouts[:, -1].T),
        timing.schedule.time_step,
        (timing.counted_until - timing.first_look) * stride,
        stride=stride,
    )
    return np.concatenate([washouts[:, :-1], samples.transpose(2, 0, 1)], axis=1)


def _check_given(experiment: ControlExperiment, timing: Timing, noise: FloatArray | None) -> None:
    dimension, washout = experiment.system.dimension, timing.schedule.washout
    flows, length = len(experiment.washouts), timing.length
    if experiment.washouts.shape != (flows, washout, dimension):
        raise ValueError(
            f"the washouts must have the shape (flows, {washout}, {dimension}), "
            f"not {experiment.washouts.shape}"
        )
    observed = dimension
    if experiment.sensor is not None:
        observed = len(experiment.sensor(np.zeros((dimension, 1))))
    if noise is not None and (
        noise.ndim != 3
        or (noise.shape[0], noise.shape[2]) != (flows, observed)
        or noise.shape[1] < length
    ):
        raise ValueError(
            f"the noise must have the shape ({flows}, {length} or more, {observed}), "
            f"not {noise.shape}"
        )
    if experiment.actuated_system.dimension != dimension:
        raise ValueError("the equations under actuation have another dimension")
