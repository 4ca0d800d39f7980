"""Flows under decisions at equal intervals: look, switch on or off, look again.

Receding-horizon control is of this kind, and so is a rule that reacts to what is observed now: they
differ in who decides. The paper's strategy, whose alarms have windows, is in
`burstcast.control.flows`.

What decides is given the last observed states, whatever equations they came under. Those under
actuation belong to another flow than the one that forecasters were trained on; what is asked of a
forecaster is the free flow from the present state on, were the actuation off. The present state
lies in the same state space, and a reservoir forgets its inputs within a few steps, but its washout
is not one that it has seen. Each decision is therefore also compared with the truth, apart for
decisions whose washout has steps under actuation and for those whose has none (`Decisions`).
"""

from dataclasses import dataclass

import numpy as np

from burstcast.arrays import BoolArray, FloatArray, IntArray
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
    uncontrolled_flows,
)
from burstcast.control.timing import DecisionTiming
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.integration import integrate, integrate_switched


@dataclass(frozen=True)
class Decisions:
    """All decisions, each ``(flows, timing.decisions)``.

    Attributes
    ----------
    on
        Whether the actuation was switched on.
    event_ahead
        Whether the free flow from the state at the decision, under no actuation from there on, is
        at or above the event threshold within the horizon; None where nobody looks ahead.
    washout_actuated
        Whether the flow came to any step of the washout, after its first, under actuation.
    """

    on: BoolArray
    event_ahead: BoolArray | None
    washout_actuated: BoolArray


@dataclass(frozen=True)
class DecidedFlows(FollowedFlows):
    """Flows under decisions at equal intervals, and the same flows without control.

    Attributes
    ----------
    timing
        Which steps count, and when decisions are made.
    decisions
        What was decided.
    """

    timing: DecisionTiming
    decisions: Decisions


def run_decided_flows(
    system: DynamicalSystem,
    washouts: FloatArray,
    monitor: Monitor,
    actuated_system: DynamicalSystem,
    timing: DecisionTiming,
    threshold: float,
    *,
    noise: FloatArray | None = None,
    quiet_starts: bool = True,
    horizon: int = 0,
    keep_states: bool = False,
) -> DecidedFlows:
    """Follow flows under decisions at equal intervals, and the same flows without control.

    At each decision the monitor sees the last observed states. Where it raises an alarm the flow
    obeys the equations under actuation until the next decision takes effect, and its own equations
    where it does not.

    Parameters
    ----------
    system
        The equations without actuation.
    washouts
        True states of the first washout, ``(flows, timing.washout, dimension)``: from the last one
        both the controlled and the uncontrolled flow are integrated.
    monitor
        Who decides; it is asked for forecast 0, 1, ... of each flow.
    actuated_system
        The equations under actuation.
    timing
        When decisions are made, when they take effect, and which steps count.
    threshold
        The event threshold, k_e.
    noise, quiet_starts, keep_states
        As in `burstcast.control.flows.run_controlled_flows`.
    horizon
        Steps after a decision over which it is compared with the free flow; 0: it is not.

    Raises
    ------
    ValueError
        If an array has the wrong shape.
    FloatingPointError
        If a flow leaves the range of floating-point numbers.
    """
    check_given(system, actuated_system, washouts, timing, noise)
    batches = []
    for rows in flow_batches(len(washouts)):
        uncontrolled_states = uncontrolled_flows(system, washouts[rows], timing)
        uncontrolled = observable_of(system, uncontrolled_states)
        given = len(rows)
        if quiet_starts:
            quiet = quiet_flows(uncontrolled, timing, threshold)
            rows, uncontrolled = rows[quiet], uncontrolled[quiet]
            uncontrolled_states = uncontrolled_states[quiet]
        counted = slice(timing.counted_from + 1, timing.length)
        uncontrolled_energy = energy_means(system, uncontrolled_states[:, counted])
        kept_uncontrolled_states = uncontrolled_states if keep_states else None
        del uncontrolled_states
        states, acting, decisions = _decided(
            system,
            actuated_system,
            washouts[rows],
            monitor,
            timing,
            threshold,
            None if noise is None else noise[rows],
            horizon,
            rows,
        )
        actuated = actuated_samples(acting, timing)
        counted_steps, switchings = counted_actuation(acting, timing)
        batches.append(
            DecidedFlows(
                timing=timing,
                threshold=threshold,
                rows=rows,
                left_out=given - len(rows),
                uncontrolled=uncontrolled,
                controlled=observable_of(system, states),
                actuated=actuated,
                actuated_integration_steps=counted_steps,
                switchings=switchings,
                uncontrolled_energy=uncontrolled_energy,
                controlled_energy=energy_means(
                    system, states[:, counted], actuated_system, actuated[:, counted]
                ),
                uncontrolled_states=kept_uncontrolled_states,
                controlled_states=states if keep_states else None,
                decisions=decisions,
            )
        )
    return _concatenate(batches)


def _decided(
    system: DynamicalSystem,
    actuated_system: DynamicalSystem,
    washouts: FloatArray,
    monitor: Monitor,
    timing: DecisionTiming,
    threshold: float,
    noise: FloatArray | None,
    horizon: int,
    rows: IntArray,
) -> tuple[FloatArray, BoolArray, Decisions]:
    """Controlled states ``(flows, timing.length, dimension)``, actuation, and the decisions."""
    flows, stride = len(rows), timing.sampling_stride
    states = np.empty((flows, timing.length, system.dimension))
    states[:, : timing.washout] = washouts
    # entry i: whether the integration step from i to i + 1 time steps after step 0 is actuated
    acting = np.zeros((flows, (timing.length - 1) * stride), dtype=bool)
    on = np.zeros((flows, timing.decisions), dtype=bool)
    event_ahead, washout_actuated = np.zeros_like(on), np.zeros_like(on)
    now = timing.first_forecast
    for number in range(timing.decisions):
        behind = slice(now + 1 - timing.washout, now + 1)
        observed = states[:, behind] if noise is None else states[:, behind] + noise[:, behind]
        alarm = monitor.alarms(
            rows,
            np.full(flows, number, dtype=np.int64),
            np.ascontiguousarray(observed.transpose(1, 2, 0)),
        )
        on[:, number] = alarm
        washout_actuated[:, number] = acting[:, behind.start * stride : now * stride].any(axis=1)
        if horizon:
            event_ahead[:, number] = _free_flow_reaches(
                system, states[:, now], timing, threshold, horizon
            )
        effect = slice(
            (now + timing.delay) * stride, (now + timing.delay + timing.interval) * stride
        )
        acting[:, effect] = alarm[:, np.newaxis]
        stop = timing.counted_until
        if number + 1 < timing.decisions:
            stop = now + timing.interval
        samples = integrate_switched(
            (system, actuated_system),
            acting[:, now * stride : stop * stride].T.view(np.uint8),
            states[:, now].T,
            timing.time_step,
            stride,
        )[1:]
        states[:, now + 1 : stop + 1] = samples.transpose(2, 0, 1)
        now = stop
    return states, acting, Decisions(on, event_ahead if horizon else None, washout_actuated)


def _free_flow_reaches(
    system: DynamicalSystem,
    states: FloatArray,
    timing: DecisionTiming,
    threshold: float,
    horizon: int,
) -> BoolArray:
    """Whether flows from states ``(flows, dimension)`` reach the threshold within the horizon."""
    stride = timing.sampling_stride
    samples = integrate(
        system, np.ascontiguousarray(states.T), timing.time_step, horizon * stride, stride=stride
    )
    observable = system.observable(np.ascontiguousarray(samples[1:].transpose(1, 0, 2)))
    return np.asarray((observable >= threshold).any(axis=0))


def _concatenate(batches: list[DecidedFlows]) -> DecidedFlows:
    parts = [batch.decisions for batch in batches]
    ahead = [part.event_ahead for part in parts if part.event_ahead is not None]
    return DecidedFlows(
        **concatenated(batches),
        timing=batches[0].timing,
        decisions=Decisions(
            on=np.concatenate([part.on for part in parts]),
            event_ahead=np.concatenate(ahead) if ahead else None,
            washout_actuated=np.concatenate([part.washout_actuated for part in parts]),
        ),
    )
