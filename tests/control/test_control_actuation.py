"""What an actuation changes, which way a force pushes, and what that costs."""

from dataclasses import replace

import numpy as np
import pytest
from helpers_control import FLOW, RAISED, experiment, plain_flow, run

from burstcast.control import loop as loop_module
from burstcast.control.actuation import actuated_system, reversed_actuation
from burstcast.control.energy import actuation_cost
from burstcast.control.strategies.reactive import Reactive, quantity
from burstcast.systems.flow_map import FlowMap
from burstcast.systems.forced import ForcedSystem

STATES = np.random.default_rng(0).normal(scale=0.1, size=(9, 5))


@pytest.mark.parametrize(
    ("strength", "reynolds"), [(1.0, 2000.0), (0.5, 1200.0), (0.25, 800.0), (0.125, 600.0)]
)
def test_actuated_system_changes_parameters_and_adds_a_force_by_its_strength(strength, reynolds):
    changed = replace(FLOW, reynolds=reynolds)
    assert actuated_system(FLOW, {"reynolds": 2000.0}, None, strength) == changed
    force = np.arange(9.0)
    for parameters, system in (({"reynolds": 2000.0}, changed), ({}, FLOW)):
        pushed = actuated_system(FLOW, parameters, list(force), strength)
        expected = system.right_hand_side(STATES) + (strength * force)[:, np.newaxis]
        np.testing.assert_array_equal(pushed.right_hand_side(STATES), expected)
        np.testing.assert_array_equal(pushed.observable(STATES), FLOW.observable(STATES))
        assert (pushed.dimension, pushed.observable_symbol) == (9, "k")
    assert FLOW.reynolds == 400.0


@pytest.mark.parametrize(
    ("system", "parameters", "force", "strength", "message"),
    [
        (FLOW, {}, [1.0], 1.0, "9 finite components"),
        (FLOW, {}, [np.inf] * 9, 1.0, "9 finite components"),
        (FLOW, {"renolds": 2000.0}, None, 1.0, "renolds.*reynolds"),
        (FLOW, {}, None, 1.0, "changes a parameter"),
        (ForcedSystem(FLOW, [0.0] * 9), {"reynolds": 2000.0}, None, 1.0, "dataclass"),
        *((FLOW, {"reynolds": 2000.0}, None, none, "strength") for none in (0.0, -1.0, np.nan)),
    ],
)
def test_an_actuation_that_cannot_be_is_refused(system, parameters, force, strength, message):
    with pytest.raises(ValueError, match=message):
        actuated_system(system, parameters, force, strength)


# -- a force that is pushed either way, and its cost

PUSH = [0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
FORWARD, BACKWARD = actuated_system(FLOW, {}, PUSH), reversed_actuation(FLOW, PUSH)
STRATEGY = Reactive(decision_interval_lt=0.25, level=0.25, watch="a1", push="-a2")


def test_energies_and_costs_of_flows_pushed_against_a_mode_are_those_of_a_plain_loop(monkeypatch):
    monkeypatch.setattr(loop_module, "FLOWS_PER_BATCH", 4)
    given = experiment(10, actuated_system=FORWARD, reversed_system=BACKWARD)

    def decide(_, state):
        a1, a2 = state[:2, 0]
        return (2 if a2 > 0 else 1) if a1 >= 0.25 else 0

    flows = run(STRATEGY, given, None, keep_states=True, costs=True)
    timing, seen = flows.timing, set()
    for position, row in enumerate(flows.rows):
        plain = plain_flow(given, row, timing, decide)
        np.testing.assert_array_equal(flows.controlled_states[position], plain.controlled)
        acting = plain.acting[3::4][: timing.length - 1]
        assert flows.actuated[position, 1:].tolist() == [bool(number) for number in acting]
        seen.update(acting)
        counted, costs = range(timing.counted_from, timing.counted_until), {}
        costs["effort"] = [0.01 * (acting[step] != 0) for step in counted]
        third = plain.controlled[1:, 2]
        costs["power"] = [0.01 * abs(third[step]) * (acting[step] != 0) for step in counted]
        for name, of_steps in costs.items():
            cost = getattr(flows.cost, name)[position]
            assert cost == pytest.approx(np.mean(of_steps), rel=1e-9, abs=1e-15)
        # each step has the budget of the equations under which the flow came to it
        for run_name, states in (
            ("uncontrolled", plain.uncontrolled),
            ("controlled", plain.controlled),
        ):
            budgets = [
                given.systems[acting[step] if run_name == "controlled" else 0].energy_budget(
                    states[step + 1][:, np.newaxis]
                )
                for step in counted
            ]
            for name in ("input", "dissipation"):
                mean = np.mean([getattr(budget, name)[0] for budget in budgets])
                recorded = getattr(getattr(flows, f"{run_name}_energy"), name)[position]
                assert recorded == pytest.approx(mean, rel=1e-12)
    assert seen == {0, 1, 2}


def test_the_cost_of_a_changed_parameter_is_that_of_the_force_that_does_the_same():
    states = np.random.default_rng(1).normal(0, 0.2, (2, 5, 9))
    actuation = np.array([[0, 1, 1, 0, 1], [0, 0, 0, 0, 0]], dtype=np.uint8)
    cost = actuation_cost((FLOW, RAISED), states, actuation)
    efforts, powers = [], []
    for state, on in zip(states[0], actuation[0], strict=True):
        force = RAISED.right_hand_side(state) - FLOW.right_hand_side(state)
        efforts.append(on * np.linalg.norm(force))
        powers.append(on * abs(state @ force))
    assert cost.effort.tolist() == [pytest.approx(np.mean(efforts)), 0.0]
    assert cost.power.tolist() == [pytest.approx(np.mean(powers)), 0.0]
    # the energy changes by that power: dk/dt with the actuation less without it
    budgets = [system.energy_budget(states[0].T) for system in (FLOW, RAISED)]
    rates = [budget.input - budget.dissipation for budget in budgets]
    assert cost.power[0] == pytest.approx(np.mean(actuation[0] * np.abs(rates[1] - rates[0])))


def test_a_map_has_no_equivalent_force():
    class Shift(FlowMap):
        dimension = 1

        def flow_map(self, state, time_step):
            return state

        def observable(self, state):
            return state[0]

    states, actuation = np.zeros((1, 2, 1)), np.ones((1, 2), dtype=np.uint8)
    assert actuation_cost((Shift(), Shift()), states, actuation) is None


def test_quantities_are_expressions_of_the_components():
    states = np.random.default_rng(2).normal(size=(9, 4))
    values = quantity("a1 - 2 * a9**2 + observable", FLOW)(states)
    expected = states[0] - 2 * states[8] ** 2 + FLOW.observable(states)
    np.testing.assert_allclose(values, expected)
    with pytest.raises(ValueError, match=r"unknown name 'a10'.*known are a1, a2, .* observable"):
        quantity("a10 + 1", FLOW)


def test_only_a_force_can_be_reversed():
    given = experiment(2)
    with pytest.raises(ValueError, match="only a force can be reversed"):
        STRATEGY.policy(given, None)
    state = np.random.default_rng(3).normal(size=(9, 3))
    together = FORWARD.right_hand_side(state) + BACKWARD.right_hand_side(state)
    np.testing.assert_allclose(together, 2 * FLOW.right_hand_side(state))
    assert isinstance(BACKWARD, ForcedSystem)
