"""Decisions at equal intervals: the flows, what is observed, and how good decisions were."""

from dataclasses import replace

import numpy as np
import pytest
from helpers_control import (
    Rotor,
    TableMonitor,
    run_sampled,
    table_monitor,
    turbulent_washouts,
    washouts_of,
)
from helpers_decisions import plain_decisions
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.control.actuation import actuated_system
from burstcast.control.monitors.horizon import HorizonMonitor
from burstcast.control.sampled.outcome import count_decisions
from burstcast.control.timing import DecisionTiming
from burstcast.forecasters.equations import EquationsFromTruth
from burstcast.systems.integration import integrate
from burstcast.systems.mfe import MoehlisFaisstEckhardt

FLOW = MoehlisFaisstEckhardt(reynolds=400.0)
RAISED = actuated_system(FLOW, {"reynolds": 2000.0})
TIMING = DecisionTiming(
    interval_lt=0.25,
    delay_lt=0.0,
    span_lt=3.0,
    quiet_lt=1.0,
    washout=5,
    steps_per_lyapunov_time=20,
    sampling_stride=4,
    time_step=0.25,
)


def perfect(threshold: float, horizon: int) -> HorizonMonitor:
    return HorizonMonitor(EquationsFromTruth(FLOW, 0.25, 4), FLOW.observable, horizon, threshold)


def never(flows: int, timing: DecisionTiming) -> TableMonitor:
    return table_monitor(np.zeros((flows, timing.most_forecasts), dtype=bool))


@st.composite
def timings(draw: st.DrawFn) -> DecisionTiming:
    return DecisionTiming(
        interval_lt=draw(st.sampled_from([0.25, 0.5, 1.0])),
        delay_lt=draw(st.sampled_from([0.0, 0.25, 0.6, 2.0])),
        span_lt=draw(st.sampled_from([1.0, 2.5])),
        quiet_lt=draw(st.sampled_from([0.0, 0.5, 2.0])),
        washout=draw(st.integers(1, 4)),
        steps_per_lyapunov_time=draw(st.integers(4, 9)),
        sampling_stride=draw(st.integers(1, 3)),
        time_step=0.3,
    )


@settings(max_examples=60, deadline=None)
@given(timings(), st.integers(1, 12), st.integers(0, 2**32 - 1))
def test_flows_are_those_of_a_plain_loop_bit_for_bit(
    timing: DecisionTiming, horizon: int, seed: int
) -> None:
    generator = np.random.default_rng(seed)
    system, actuated = Rotor(0.3), Rotor(0.9)
    washouts = washouts_of(system, generator.normal(size=(2, 5)), timing)
    table = generator.random((5, timing.most_forecasts)) < 0.4
    monitor = table_monitor(table)
    flows = run_sampled(
        system, washouts, monitor, actuated, timing, 0.9, horizon=horizon, keep_states=True
    )
    assert flows.controlled_states is not None
    assert flows.left_out == 5 - len(flows)
    ahead = flows.decisions.event_ahead
    assert ahead is not None
    for flow, row in enumerate(flows.rows):
        plain = plain_decisions(
            system,
            actuated,
            washouts[row],
            lambda number, seen, row=row: bool(table[row, number]),
            timing,
            0.9,
            horizon,
        )
        np.testing.assert_array_equal(flows.controlled_states[flow], plain.controlled)
        np.testing.assert_array_equal(flows.controlled[flow], plain.controlled[:, 0])
        assert flows.decisions.on[flow].tolist() == plain.on == table[row].tolist()
        assert ahead[flow].tolist() == plain.event_ahead
        assert flows.decisions.washout_actuated[flow].tolist() == plain.washout_actuated
        stride = timing.sampling_stride
        counted = plain.acting[timing.counted_from * stride : timing.counted_until * stride]
        assert flows.actuated_integration_steps[flow] == sum(counted)
        rises = [
            now and not before for before, now in zip([False, *counted], counted, strict=False)
        ]
        assert flows.switchings[flow] == sum(rises)
        into_step = plain.acting[stride - 1 :: stride][: timing.length - 1]
        assert flows.actuated[flow, 1:].tolist() == into_step
        for number in range(timing.most_forecasts):
            now = timing.first_forecast + number * timing.interval
            np.testing.assert_array_equal(
                monitor.seen[int(row), number], plain.controlled[now + 1 - timing.washout : now + 1]
            )
    # flows that were left out, and those that were not
    assert len(flows) == sum(
        float(np.max(integrated)) < 0.9
        for integrated in (
            integrate(
                system,
                np.ascontiguousarray(washout[0][:, np.newaxis]),
                timing.time_step,
                timing.counted_from * timing.sampling_stride,
                stride=timing.sampling_stride,
            )[:, 0]
            for washout in washouts
        )
    )


def test_always_on_is_the_flow_under_actuation() -> None:
    washouts = turbulent_washouts(FLOW, 2, TIMING)
    monitor = table_monitor(np.ones((2, TIMING.most_forecasts), dtype=bool))
    flows = run_sampled(FLOW, washouts, monitor, RAISED, TIMING, np.inf, keep_states=True)
    steps = TIMING.counted_until - TIMING.first_forecast
    expected = integrate(RAISED, washouts[:, -1].T.copy(), 0.25, steps * 4, stride=4)
    assert flows.controlled_states is not None
    np.testing.assert_array_equal(
        flows.controlled_states[:, TIMING.first_forecast :], expected.transpose(2, 0, 1)
    )
    assert flows.switchings.tolist() == [1, 1]
    # the first washout is free, the second reaches back to the first decision
    assert flows.decisions.washout_actuated[0].tolist() == [False] + [True] * (
        TIMING.most_forecasts - 1
    )


def test_a_delay_puts_off_what_was_decided() -> None:
    """Decisions of the late actuator act when those of the prompt one did, a delay later."""
    washouts = turbulent_washouts(FLOW, 2, TIMING)
    late = replace(TIMING, delay_lt=0.5)  # two intervals
    table = np.random.default_rng(1).random((2, TIMING.most_forecasts)) < 0.5
    table[:, :2] = False
    shifted = table[:, 2:]
    prompt = run_sampled(FLOW, washouts, table_monitor(table), RAISED, TIMING, np.inf)
    delayed = run_sampled(FLOW, washouts, table_monitor(shifted), RAISED, late, np.inf)
    assert late.most_forecasts == TIMING.most_forecasts - 2
    np.testing.assert_array_equal(prompt.controlled, delayed.controlled)
    np.testing.assert_array_equal(prompt.actuated, delayed.actuated)


def test_a_perfect_forecaster_decides_rightly_and_leaves_no_event() -> None:
    timing = replace(TIMING, steps_per_lyapunov_time=61, span_lt=5.0, quiet_lt=2.0, washout=1)
    horizon = 122
    washouts = turbulent_washouts(FLOW, 40, timing)
    flows = run_sampled(FLOW, washouts, perfect(0.1, horizon), RAISED, timing, 0.1, horizon=horizon)
    assert (flows.uncontrolled[:, timing.counted_from :] >= 0.1).any(axis=1).sum() > 5
    assert flows.controlled[:, timing.counted_from :].max() < 0.1
    outcome = count_decisions(flows, None, np.array([0.0, 0.1, 0.5]))
    assert outcome.alarms == outcome.free_true_alarms + outcome.actuated_true_alarms > 0
    assert outcome.free_missed == outcome.actuated_missed == 0
    assert outcome.free_false_alarms == outcome.actuated_false_alarms == 0
    assert outcome.free_quiet + outcome.actuated_quiet + outcome.alarms == outcome.decisions
    assert outcome.exceeding_controlled == outcome.events_controlled == 0
    assert outcome.exceedance_uncontrolled > 0
    assert outcome.reduction == 1


def test_the_eight_kinds_of_decisions_are_counted_apart() -> None:
    """A rotor that is decided on by a table: each decision falls in the kind of its own flow."""
    timing = replace(TIMING, quiet_lt=0.0, washout=3)
    generator = np.random.default_rng(0)
    system = Rotor(0.3)
    washouts = washouts_of(system, 0.6 * generator.normal(size=(2, 8)), timing)
    table = generator.random((8, timing.most_forecasts)) < 0.4
    flows = run_sampled(
        system,
        washouts,
        table_monitor(table),
        Rotor(0.5),
        timing,
        0.7,
        quiet_starts=False,
        horizon=3,
    )
    assert (len(flows), flows.left_out) == (8, 0)
    outcome = count_decisions(flows, None, np.array([0.0, 1.0]))
    found = dict.fromkeys(
        (f"{w}_{k}" for w in ("free", "actuated") for k in ("true_alarms", "false_alarms")), 0
    ) | dict.fromkeys((f"{w}_{k}" for w in ("free", "actuated") for k in ("missed", "quiet")), 0)
    names = {
        (True, True): "true_alarms",
        (True, False): "false_alarms",
        (False, True): "missed",
        (False, False): "quiet",
    }
    for row in range(8):
        plain = plain_decisions(
            system,
            Rotor(0.5),
            washouts[row],
            lambda number, seen, row=row: bool(table[row, number]),
            timing,
            0.7,
            3,
        )
        for on, ahead, behind in zip(
            plain.on, plain.event_ahead, plain.washout_actuated, strict=True
        ):
            found[f"{'actuated' if behind else 'free'}_{names[on, ahead]}"] += 1
    assert {name: getattr(outcome, name) for name in found} == found
    # without a horizon nothing says what was right
    blind = replace(flows, decisions=replace(flows.decisions, event_ahead=None))
    counted = count_decisions(blind, None, np.array([0.0, 1.0]))
    assert {name: getattr(counted, name) for name in found} == dict.fromkeys(found, 0)
    assert min(found.values()) > 0
    assert sum(found.values()) == outcome.decisions == 8 * timing.most_forecasts


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"interval_lt": 0.01}, "interval between two decisions"),
        ({"delay_lt": -0.1}, "delay must not be negative"),
        ({"quiet_lt": -0.1}, "begin after the first"),
        ({"span_lt": 0.0}, "last a step"),
    ],
)
def test_timings_that_mean_nothing_are_refused(change: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(TIMING, **change)  # type: ignore[arg-type]
