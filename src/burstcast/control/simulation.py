"""Simulation of flows with and without control: the one loop of all strategies.

All flows of a batch move together, each on its own clock. At each look the monitor sees the last
observed states of a flow; its alarm sets off the actuation for an interval after the look. When the
looks are, how long that interval is and what is recorded of an alarm is the strategy's `Stepper`.
"""

import abc
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any, ClassVar, Generic, TypeVar

import numpy as np
import numpy.typing as npt

from burstcast.arrays import BoolArray, ByteArray, FloatArray, IntArray
from burstcast.control.actuation import REVERSED
from burstcast.control.cost import ActuationCost, actuation_cost
from burstcast.control.monitors.base import Decision, Monitor
from burstcast.control.timing import Clock
from burstcast.systems.base import DynamicalSystem, EnergyBudget
from burstcast.systems.integration import LostTrajectoryError, integrate, integrate_switched

FLOWS_PER_BATCH = 1024
"""Flows that are simulated side by side: bounds the memory, changes no result."""

Sensor = Callable[[FloatArray], FloatArray]
"""What is observed of states: from ``(dimension, ...)`` to ``(observed components, ...)``."""

Timed = TypeVar("Timed", bound=Clock)
Decided = TypeVar("Decided")
Entry = TypeVar("Entry", bound=np.generic)


@dataclass(frozen=True)
class EnergyMeans:
    """Energy input and dissipation of each flow, averaged over the steps that count, ``(flows,)``.

    Attributes
    ----------
    input
        Work of the forces per unit of time (see `DynamicalSystem.energy_budget`).
    dissipation
        Energy that viscosity takes per unit of time.
    """

    input: FloatArray
    dissipation: FloatArray


@dataclass(frozen=True)
class ControlSimulation(Generic[Timed, Decided]):
    """Flows with and without control, from the same states over the same steps.

    Attributes
    ----------
    timing
        Which steps count.
    threshold
        The event threshold, k_e.
    left_out
        Number of flows that were left out, since they had an event before their steps count.
    rows
        Rows of the simulated flows among the given ones, ``(flows,)``.
    uncontrolled, controlled
        Observable, ``(flows, timing.length)``.
    actuated
        Whether the controlled flow came to each step under actuation, ``(flows, timing.length)``.
    actuated_integration_steps
        Integration steps under actuation among the counted ones, ``(flows,)``.
    switchings
        Number of times that the actuation was switched on among the integration steps that count,
        ``(flows,)``; an actuation that is on at the first of them counts.
    uncontrolled_energy, controlled_energy
        Energy input and dissipation; None for a system without an energy budget.
    uncontrolled_states, controlled_states
        States, ``(flows, timing.length, dimension)``; None unless they were asked for.
    decisions
        What the monitor said at each look, and what came of it (`Stepper.decisions`).
    cost
        Effort and power of the actuation; None for a system without a right-hand side.
    """

    timing: Timed
    threshold: float
    left_out: int
    rows: IntArray
    uncontrolled: FloatArray
    controlled: FloatArray
    actuated: BoolArray
    actuated_integration_steps: IntArray
    switchings: IntArray
    uncontrolled_energy: EnergyMeans | None
    controlled_energy: EnergyMeans | None
    uncontrolled_states: FloatArray | None
    controlled_states: FloatArray | None
    decisions: Decided
    cost: ActuationCost | None = None

    def __len__(self) -> int:
        """Return the number of flows."""
        return len(self.rows)


@dataclass(frozen=True)
class Stepper(abc.ABC, Generic[Timed, Decided]):
    """Advances controlled flows: times of decisions, and actuation after alarms.

    Attributes
    ----------
    system, actuated_system
        The equations without and under actuation.
    monitor
        Raises the alarms; it is asked for forecast 0, 1, ... of each flow.
    timing
        When the first look is, and which steps count.
    threshold
        The event threshold, k_e.
    reversed_system
        The equations under the reversed actuation; None: there is none.
    sensor
        What the monitor observes of states ``(dimension, ...)``; None: the whole state.
    """

    system: DynamicalSystem
    actuated_system: DynamicalSystem
    monitor: Monitor
    timing: Timed
    threshold: float
    reversed_system: DynamicalSystem | None = field(default=None, kw_only=True)
    sensor: Sensor | None = field(default=None, kw_only=True)

    @property
    def systems(self) -> tuple[DynamicalSystem, ...]:
        """The equations without actuation, under it, and under the reversed one if there is one."""
        further = () if self.reversed_system is None else (self.reversed_system,)
        return self.system, self.actuated_system, *further

    judgements: ClassVar[tuple[str, ...]]
    """Names of what `judge` returns."""

    @property
    @abc.abstractmethod
    def effect(self) -> tuple[int, int]:
        """First integration step under actuation after an alarm, and the first free one after it.

        Integration step i leads from i to i + 1 time steps after the alarm.
        """

    @property
    @abc.abstractmethod
    def pauses(self) -> tuple[int, int]:
        """Steps from a look to the next one: without an alarm, and after one, which is no less."""

    @abc.abstractmethod
    def judge(
        self, flows: "RunningFlows", due: IntArray, decision: Decision
    ) -> dict[str, BoolArray]:
        """Compare alarms with the truth, before they take effect.

        Parameters
        ----------
        flows
            The flows of the batch, known up to their clocks.
        due
            Positions of the flows at which the monitor looked, ``(due,)``.
        decision
            What it said.

        Returns
        -------
        By the names of `judgements`, ``(due,)`` each.
        """

    @abc.abstractmethod
    def decisions(self, flows: "RunningFlows", position: int) -> Decided:
        """Record of all looks at the flows of a batch, a dataclass of arrays.

        Parameters
        ----------
        flows
            The flows of the batch, at their ends.
        position
            Position of the batch's first flow among all flows that are simulated.
        """


class RunningFlows:
    """Controlled flows of one batch on their way.

    A flow that stops earlier than others, since its next look is due, goes on from there: what lies
    beyond its clock is overwritten.

    Attributes
    ----------
    states
        ``(flows, steps, dimension)``; known up to each flow's clock.
    acting
        Which actuation the integration step from i to i + 1 time steps after step 0 is under:
        0 is none, 1 the actuation, 2 the reversed one; ``(flows, integration steps)``.
    clock
        Step that each flow has reached, ``(flows,)``.
    looks
        Number of looks at each flow so far, ``(flows,)``.
    step, alarm
        Step of each look and whether it raised an alarm, ``(flows, timing.most_forecasts)``.
    judged
        What `Stepper.judge` said of each look, by name, ``(flows, timing.most_forecasts)``.
    """

    def __init__(self, stepper: Stepper[Any, Any], washouts: FloatArray) -> None:
        timing, flows = stepper.timing, len(washouts)
        self.stepper, self._stride = stepper, timing.sampling_stride
        # the last step at which an alarm could still change a step that counts
        self._last_look = (timing.counted_until * self._stride - stepper.effect[0] - 1) // (
            self._stride
        )
        self._shortest, longest = stepper.pauses
        steps = max(timing.counted_until, self._last_look + longest) + self._shortest + 1
        self.states = np.empty((flows, steps, stepper.system.dimension))
        self.states[:, : timing.washout] = washouts
        self.acting: ByteArray = np.zeros((flows, steps * self._stride), dtype=np.uint8)
        self.clock = np.full(flows, timing.first_forecast, dtype=np.int64)
        self._stop = self.clock.copy()
        entries = (flows, timing.most_forecasts)
        self.looks = np.zeros(flows, dtype=np.int64)
        self.step, self.alarm = np.zeros(entries, dtype=np.int64), np.zeros(entries, dtype=bool)
        self.judged = {name: np.zeros(entries, dtype=bool) for name in stepper.judgements}

    def run(self, rows: IntArray, noise: FloatArray | None) -> None:
        """Simulate the flows to their ends; ``rows`` are theirs among the given flows.

        Raises
        ------
        FloatingPointError
            If a flow leaves the range of floating-point numbers.
        """
        while (moving := self._moving()).size:
            due = np.flatnonzero((self.clock == self._stop) & (self.clock <= self._last_look))
            if due.size:
                self._look(due, rows[due], noise)
            self._advance_or_tell(moving, rows)

    def _moving(self) -> IntArray:
        return np.flatnonzero((self.clock < self._stop) | (self.clock <= self._last_look))

    def _look(self, due: IntArray, rows: IntArray, noise: FloatArray | None) -> None:
        """Ask the monitor about flows, and act on its alarms."""
        stepper, now, number = self.stepper, self.clock[due], self.looks[due]
        washout = stepper.timing.washout
        observed = ending_at(self.states, due, now, washout)
        if stepper.sensor is not None:
            observed = np.moveaxis(stepper.sensor(np.moveaxis(observed, -1, 0)), 0, -1)
        if noise is not None:
            observed = observed + ending_at(noise, rows, now, washout)
        decision = stepper.monitor.decide(
            rows, number, np.ascontiguousarray(observed.transpose(1, 2, 0)), self._known(due, now)
        )
        alarm, mode = decision.alarm, np.ones(len(due), dtype=np.uint8)
        if decision.reverse is not None:
            mode[decision.reverse] = REVERSED
        self.step[due, number], self.alarm[due, number] = now, alarm
        for name, values in stepper.judge(self, due, decision).items():
            self.judged[name][due, number] = values
        self.looks[due] += 1
        self._stop[due] = now + np.where(alarm, stepper.pauses[1], stepper.pauses[0])
        start, stop = stepper.effect
        begins = now[alarm] * self._stride
        for flow, step, as_told in zip(due[alarm], begins, mode[alarm], strict=True):
            self.acting[flow, step + start : step + stop] = as_told

    def _known(self, due: IntArray, now: IntArray) -> ByteArray:
        """Actuation in force over the washout, and until an alarm takes effect."""
        pending = self.stepper.effect[0] // self._stride
        steps = self.stepper.timing.washout - 1 + pending
        last = (now + pending) * self._stride - 1
        behind = ending_at(self.acting, due, last, steps * self._stride)
        return np.asarray(behind[:, self._stride - 1 :: self._stride].T)

    def _advance_or_tell(self, flows: IntArray, rows: IntArray) -> None:
        """Move flows on, or say which one actuation took out of the range of numbers."""
        try:
            self._advance(flows)
        except LostTrajectoryError as error:
            flow = int(flows[error.trajectory])
            told = self._lost_under_actuation(flow, int(rows[flow]))
            raise (FloatingPointError(told) if told else error) from error

    def _advance(self, flows: IntArray) -> None:
        """Move flows on by the shortest pause, each up to its next stop at most."""
        stride, now = self._stride, self.clock[flows]
        ahead = np.arange(self._shortest * stride)
        samples = integrate_switched(
            self.stepper.systems,
            self.acting[flows[:, np.newaxis], now[:, np.newaxis] * stride + ahead].T,
            self.states[flows, now].T,
            self.stepper.timing.time_step,
            stride,
        )[1:]
        next_steps = now[:, np.newaxis] + np.arange(1, self._shortest + 1)
        self.states[flows[:, np.newaxis], next_steps] = samples.transpose(2, 0, 1)
        self.clock[flows] = np.minimum(now + self._shortest, self._stop[flows])
        # flows that are monitored no longer move on to the last step that counts
        over = (self.clock == self._stop) & (self.clock > self._last_look)
        self._stop[over] = np.maximum(self.clock[over], self.stepper.timing.counted_until)

    def _lost_under_actuation(self, flow: int, row: int) -> str:
        """Describe how actuation took a flow out of the range of numbers; "" if it was free."""
        timing, stride = self.stepper.timing, self._stride
        end = int(self.clock[flow] + self._shortest) * stride
        acted = np.flatnonzero(self.acting[flow, :end])
        if not acted.size:
            return ""
        since, under = (steps * timing.time_step for steps in (end - acted[0], acted.size))
        return (
            f"controlled flow {row} left the range of floating-point numbers under actuation: at "
            f"most {since:g} time units after it was first actuated, {under:g} of them under "
            f"actuation. The actuated equations need a shorter ensemble.time_step than "
            f"{timing.time_step:g}, or a weaker actuation: smaller changes of "
            "actuation.parameters, a smaller actuation.force, or a smaller strength of the block "
            "of control.strategies"
        )

    def actuation(self) -> ByteArray:
        """Actuation under which flows came to each step, ``(flows, timing.length)``."""
        into_step = self.acting[:, self._stride - 1 :: self._stride]
        length = self.stepper.timing.length
        return np.pad(into_step[:, : length - 1], ((0, 0), (1, 0)))

    def counted_actuation(self) -> tuple[IntArray, IntArray]:
        """Integration steps under actuation that count, and how often it was switched on."""
        timing, stride = self.stepper.timing, self._stride
        acting = self.acting[:, timing.counted_from * stride : timing.counted_until * stride] != 0
        switched_on = acting.copy()
        switched_on[:, 1:] &= ~acting[:, :-1]
        return acting.sum(axis=1, dtype=np.int64), switched_on.sum(axis=1, dtype=np.int64)


def simulate(
    stepper: Stepper[Timed, Decided],
    washouts: FloatArray,
    *,
    noise: FloatArray | None = None,
    quiet_starts: bool = True,
    keep_states: bool = False,
) -> ControlSimulation[Timed, Decided]:
    """Simulate flows with and without control from identical states.

    Parameters
    ----------
    stepper
        How the controlled flows go on.
    washouts
        True states of the first washout, ``(flows, timing.washout, dimension)``: the last one is
        the state from which both the controlled and the uncontrolled flow are integrated.
    noise
        Observation noise, ``(flows, timing.length or more, observed components)``: what the
        monitor sees is the true state, or what the sensor observes of it, plus this, a fixed
        function of the flow and the step, with and without control. None: there is none.
    quiet_starts
        Whether to leave out flows with an event (observable at or above the threshold) before their
        steps count, while nothing could be done about it.
    keep_states
        Whether to return states. Since no flow depends on the others, a second call with a few
        flows only returns their states.

    Raises
    ------
    ValueError
        If an array has the wrong shape, or the two systems different dimensions.
    FloatingPointError
        If a flow leaves the range of floating-point numbers.
    """
    timing = stepper.timing
    _check_given(stepper, washouts, noise)
    counted = slice(timing.counted_from + 1, timing.length)
    parts: list[dict[str, Any]] = []
    simulated = 0
    # no flows at all are one empty batch
    for first in range(0, max(len(washouts), 1), FLOWS_PER_BATCH):
        rows = np.arange(first, min(first + FLOWS_PER_BATCH, len(washouts)))
        free_states = _uncontrolled_flows(stepper.system, washouts[rows], timing)
        observable = observable_of(stepper.system, free_states)
        if quiet_starts:
            before = observable[:, : timing.counted_from + 1]
            quiet = (before < stepper.threshold).all(axis=1)
            rows, observable, free_states = rows[quiet], observable[quiet], free_states[quiet]
        part = {
            "rows": rows,
            "uncontrolled": observable,
            "uncontrolled_energy": energy_means(stepper.system, free_states[:, counted]),
            "uncontrolled_states": free_states if keep_states else None,
        }
        del free_states
        flows = RunningFlows(stepper, washouts[rows])
        flows.run(rows, noise)
        states, actuation = flows.states[:, : timing.length], flows.actuation()
        acting_steps, switchings = flows.counted_actuation()
        parts.append(
            {
                **part,
                "controlled": observable_of(stepper.system, states),
                "actuated": actuation != 0,
                "actuated_integration_steps": acting_steps,
                "switchings": switchings,
                "controlled_energy": energy_means(
                    stepper.system,
                    states[:, counted],
                    stepper.systems[1:],
                    actuation[:, counted],
                ),
                "cost": actuation_cost(stepper.systems, states[:, counted], actuation[:, counted]),
                "controlled_states": states.copy() if keep_states else None,
                "decisions": stepper.decisions(flows, simulated),
            }
        )
        simulated += len(rows)
    return ControlSimulation(
        timing=timing,
        threshold=stepper.threshold,
        left_out=len(washouts) - simulated,
        **{name: _joined([part[name] for part in parts]) for name in parts[0]},
    )


def _joined(parts: Sequence[Any]) -> Any:
    """Join arrays, or dataclasses of arrays, along their first axis; None where there are none."""
    first = parts[0]
    if is_dataclass(first) and not isinstance(first, type):
        names = [one.name for one in fields(first)]
        return type(first)(
            **{name: _joined([getattr(part, name) for part in parts]) for name in names}
        )
    return None if first is None else np.concatenate(parts)


def ending_at(
    series: npt.NDArray[Entry], rows: IntArray, ends: IntArray, length: int
) -> npt.NDArray[Entry]:
    """Sections of series that end at each row's own step, ``(rows, length, ...)``."""
    steps = ends[:, np.newaxis] + np.arange(1 - length, 1)
    return np.asarray(series[rows[:, np.newaxis], steps])


def observable_of(system: DynamicalSystem, states: FloatArray) -> FloatArray:
    """Observable of states with the components last, ``(flows, steps)``."""
    return system.observable(np.ascontiguousarray(states.transpose(2, 0, 1)))


def _uncontrolled_flows(system: DynamicalSystem, washouts: FloatArray, timing: Clock) -> FloatArray:
    """Flows without control, ``(flows, timing.length, dimension)``, washouts included."""
    samples = integrate(
        system,
        np.ascontiguousarray(washouts[:, -1].T),
        timing.time_step,
        (timing.counted_until - timing.first_forecast) * timing.sampling_stride,
        stride=timing.sampling_stride,
    )
    return np.concatenate([washouts[:, :-1], samples.transpose(2, 0, 1)], axis=1)


def _check_given(
    stepper: Stepper[Any, Any], washouts: FloatArray, noise: FloatArray | None
) -> None:
    flows, length, dimension = len(washouts), stepper.timing.length, stepper.system.dimension
    if washouts.shape != (flows, stepper.timing.washout, dimension):
        raise ValueError(
            f"the washouts must have the shape (flows, {stepper.timing.washout}, {dimension}), "
            f"not {washouts.shape}"
        )
    observed = dimension
    if stepper.sensor is not None:
        observed = len(stepper.sensor(np.zeros((dimension, 1))))
    if noise is not None and (
        noise.ndim != 3
        or (noise.shape[0], noise.shape[2]) != (flows, observed)
        or noise.shape[1] < length
    ):
        raise ValueError(
            f"the noise must have the shape ({flows}, {length} or more, {observed}), "
            f"not {noise.shape}"
        )
    if stepper.actuated_system.dimension != dimension:
        raise ValueError("the equations under actuation have another dimension")


def energy_means(
    system: DynamicalSystem,
    states: FloatArray,
    actuated_systems: Sequence[DynamicalSystem] = (),
    actuation: ByteArray | None = None,
) -> EnergyMeans | None:
    """Energy input and dissipation of flows, averaged over their steps.

    A step's budget is computed by the equations under which the flow came to it.

    Parameters
    ----------
    system
        The equations.
    states
        At the steps that count, ``(flows, steps, dimension)``.
    actuated_systems, actuation
        The equations under each actuation, and under which of them, counted from 1, the flows came
        to these steps, ``(flows, steps)``, 0 for none; neither for flows without control.

    Returns
    -------
    The means; None if the equations have no energy budget.
    """
    components = np.ascontiguousarray(states.transpose(2, 0, 1))
    budget = system.energy_budget(components)
    if budget is None:
        return None
    for number, actuated_system in enumerate(actuated_systems, start=1):
        under_actuation = actuated_system.energy_budget(components)
        if under_actuation is None:
            return None
        budget = EnergyBudget(
            *(
                np.where(actuation == number, there, here)
                for there, here in zip(under_actuation, budget, strict=True)
            )
        )
    return EnergyMeans(input=budget.input.mean(axis=1), dissipation=budget.dissipation.mean(axis=1))
