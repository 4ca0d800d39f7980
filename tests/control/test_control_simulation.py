"""The one simulation of control, under both ways to look at flows."""

import re
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
import pytest
from helpers_control import (
    Rotor,
    TableMonitor,
    run_sampled,
    run_windowed,
    table_monitor,
    turbulent_washouts,
)
from test_control_decisions import TIMING as SAMPLED
from test_control_decisions import perfect
from test_control_flows import FLOW, RAISED
from test_control_flows import SHORT as WINDOWED

from burstcast.control import simulation as simulation_module
from burstcast.control.actuation import ForcedSystem
from burstcast.control.monitors.base import Monitor
from burstcast.control.monitors.forecast import ForecastMonitor
from burstcast.control.simulation import ControlSimulation
from burstcast.control.timing import Clock
from burstcast.forecasters.equations import EquationsFromTruth

Run = Callable[..., ControlSimulation[Any, Any]]
EQUATIONS = EquationsFromTruth(FLOW, 0.25, 4)
WAYS = {
    "windowed": (
        lambda *given, **options: run_windowed(FLOW, *given, **options),
        RAISED,
        WINDOWED,
        ForecastMonitor(EQUATIONS, FLOW.observable, WINDOWED, 0.07),
    ),
    "sampled": (
        lambda *given, **options: run_sampled(FLOW, *given, **options),
        RAISED.system,
        SAMPLED,
        perfect(0.07, 20),
    ),
}


@pytest.fixture(params=WAYS)
def way(request: pytest.FixtureRequest) -> tuple[Run, Any, Clock, Monitor]:
    return WAYS[request.param]


def alarms(share: float, flows: int, timing: Clock) -> TableMonitor:
    draws = np.random.default_rng(3).random((flows, timing.most_forecasts))
    return table_monitor(draws < share)


def assert_same(left: Any, right: Any) -> None:
    if is_dataclass(left):
        for field in fields(left):
            assert_same(getattr(left, field.name), getattr(right, field.name))
    else:
        np.testing.assert_array_equal(left, right)


def test_without_alarms_the_controlled_flow_is_the_uncontrolled_one(way: Any) -> None:
    run, actuation, timing, _ = way
    washouts = turbulent_washouts(FLOW, 3, timing)
    flows = run(washouts, alarms(0, 3, timing), actuation, timing, np.inf, keep_states=True)
    np.testing.assert_array_equal(flows.controlled_states, flows.uncontrolled_states)
    np.testing.assert_array_equal(flows.controlled, flows.uncontrolled)
    assert not flows.switchings.any()
    assert not flows.actuated.any()


def test_noise_belongs_to_flow_and_step_and_stays_out_of_the_truth(way: Any) -> None:
    run, actuation, timing, _ = way
    washouts = turbulent_washouts(FLOW, 4, timing)
    noise = np.random.default_rng(2).normal(size=(4, timing.length + 3, 9))
    plain, noisy = alarms(0.5, 4, timing), alarms(0.5, 4, timing)
    without = run(washouts, plain, actuation, timing, np.inf, keep_states=True)
    assert without.actuated.any()
    assert_same(
        without, run(washouts, noisy, actuation, timing, np.inf, noise=noise, keep_states=True)
    )
    assert noisy.seen.keys() == plain.seen.keys()
    for (row, number), seen in noisy.seen.items():
        states = without.controlled_states[row]
        ends = [
            now
            for now in range(timing.first_forecast, timing.length)
            if np.array_equal(states[now + 1 - timing.washout : now + 1], plain.seen[row, number])
        ]
        assert len(ends) == 1
        expected = plain.seen[row, number] + noise[row, ends[0] + 1 - timing.washout : ends[0] + 1]
        np.testing.assert_array_equal(seen, expected)


def test_results_do_not_depend_on_the_batch(way: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    run, actuation, timing, monitor = way
    washouts = turbulent_washouts(FLOW, 7, timing)
    noise = np.random.default_rng(2).normal(scale=1e-3, size=(7, timing.length, 9))

    def simulated(**options: Any) -> ControlSimulation[Any, Any]:
        return run(washouts, monitor, actuation, timing, 0.07, noise=noise, **options)

    together = simulated(keep_states=True)
    assert together.actuated.any()
    assert 0 < len(together) < 7
    monkeypatch.setattr(simulation_module, "FLOWS_PER_BATCH", 2)
    assert_same(together, simulated(keep_states=True))
    flow = int(np.flatnonzero(together.actuated.any(axis=1))[0])
    row = [together.rows[flow]]
    alone = run(washouts[row], monitor, actuation, timing, 0.07, noise=noise[row])
    np.testing.assert_array_equal(alone.controlled[0], together.controlled[flow])
    assert alone.controlled_states is None
    np.testing.assert_array_equal(
        FLOW.observable(together.controlled_states[flow].T), together.controlled[flow]
    )


def test_flows_that_are_not_quiet_at_the_start_are_left_out_where_they_must_be(way: Any) -> None:
    run, actuation, timing, _ = way
    washouts, never = turbulent_washouts(FLOW, 2, timing), alarms(0, 2, timing)
    quiet = run(washouts, never, actuation, timing, 0.0, keep_states=True)
    assert (len(quiet), quiet.left_out) == (0, 2)
    assert quiet.controlled.shape == (0, timing.length)
    flows = run(washouts, never, actuation, timing, 0.0, quiet_starts=False)
    assert (len(flows), flows.left_out) == (2, 0)
    nothing = run(washouts[:0], alarms(0, 0, timing), actuation, timing, 0.1)
    assert (len(nothing), nothing.left_out) == (0, 0)


def test_wrong_shapes_are_refused() -> None:
    washouts, monitor = turbulent_washouts(FLOW, 2, SAMPLED), alarms(0, 2, SAMPLED)
    with pytest.raises(ValueError, match="washouts must have the shape"):
        run_sampled(FLOW, washouts[:, 1:], monitor, RAISED.system, SAMPLED, 0.1)
    noise = np.zeros((2, SAMPLED.length - 1, 9))
    with pytest.raises(ValueError, match="noise must have the shape"):
        run_sampled(FLOW, washouts, monitor, RAISED.system, SAMPLED, 0.1, noise=noise)
    with pytest.raises(ValueError, match="another dimension"):
        run_sampled(FLOW, washouts, monitor, Rotor(1.0), SAMPLED, 0.1)


def test_a_flow_that_actuation_takes_out_of_the_range_of_numbers(way: Any) -> None:
    """The message tells which flow, after how much time, and what to change."""
    run, actuation, timing, _ = way
    pushed = ForcedSystem(FLOW, [1e200] * 9)
    violent = pushed if timing is SAMPLED else actuation._replace(system=pushed)
    table = np.zeros((3, timing.most_forecasts), dtype=bool)
    table[1, 1] = True
    with pytest.raises(FloatingPointError) as caught:
        run(turbulent_washouts(FLOW, 3, timing), table_monitor(table), violent, timing, 10.0)
    assert re.match(
        "controlled flow 1 left the range of floating-point numbers under actuation: at most "
        r"(5 time units after it was first actuated, 5|20 .*, 20) of them under actuation\. The "
        "actuated equations need a shorter ensemble.time_step than 0.25, or a weaker actuation",
        str(caught.value),
    ), caught.value
