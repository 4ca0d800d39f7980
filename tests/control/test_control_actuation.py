"""What an actuation changes, which way a force pushes, and what that costs."""

from dataclasses import replace

import numpy as np
import pytest
from helpers_control import FLOW, RAISED, Rotor, experiment, run

from burstcast.control.actuation import ForcedSystem, actuated_system, reversed_actuation
from burstcast.control.energy import actuation_cost
from burstcast.control.strategies.reactive import Reactive, quantity
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.flow_map import FlowMap
from burstcast.systems.integration import integrate
from burstcast.systems.kolmogorov import KolmogorovFlow
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.runge_kutta import step

STATES = np.random.default_rng(0).normal(scale=0.1, size=(9, 5))


def test_changed_parameter_is_the_system_with_that_parameter() -> None:
    actuated = actuated_system(FLOW, {"reynolds": 2000.0})
    expected = MoehlisFaisstEckhardt(reynolds=2000.0).right_hand_side(STATES)
    np.testing.assert_array_equal(actuated.right_hand_side(STATES), expected)
    assert FLOW.reynolds == 400.0


def test_force_is_added_to_the_changed_system() -> None:
    force = np.arange(9.0)
    actuated = actuated_system(FLOW, {"reynolds": 2000.0}, list(force))
    expected = MoehlisFaisstEckhardt(reynolds=2000.0).right_hand_side(STATES) + force[:, np.newaxis]
    np.testing.assert_array_equal(actuated.right_hand_side(STATES), expected)
    np.testing.assert_array_equal(actuated.observable(STATES), FLOW.observable(STATES))
    assert (actuated.dimension, actuated.observable_symbol) == (9, "k")


def test_jacobian_does_not_know_the_force() -> None:
    forced = ForcedSystem(FLOW, [1.0] * 9)
    np.testing.assert_array_equal(forced.jacobian(STATES), FLOW.jacobian(STATES))


def test_forced_batches_of_more_than_one_are_integrated_like_single_flows() -> None:
    forced: DynamicalSystem = ForcedSystem(Rotor(1.0), [0.3, -0.1])
    states = np.random.default_rng(1).normal(size=(2, 4))
    together = integrate(forced, states, 0.1, 20)
    for flow in range(4):
        alone = integrate(forced, states[:, flow : flow + 1], 0.1, 20)
        np.testing.assert_array_equal(together[:, :, flow : flow + 1], alone)


@pytest.mark.parametrize("force", [[1.0], [np.inf] * 9])
def test_bad_force_is_refused(force: list[float]) -> None:
    with pytest.raises(ValueError, match="9 finite components"):
        actuated_system(FLOW, {}, force)


def test_unknown_parameter_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match=r"renolds.*reynolds"):
        actuated_system(FLOW, {"renolds": 2000.0})


def test_actuation_that_changes_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="changes a parameter"):
        actuated_system(FLOW, {})


def test_parameters_of_a_forced_system_cannot_be_changed() -> None:
    with pytest.raises(ValueError, match="dataclass"):
        actuated_system(ForcedSystem(FLOW, [0.0] * 9), {"reynolds": 2000.0})


# -- a force that is pushed either way, and its cost

PUSH = [0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
FORWARD, BACKWARD = actuated_system(FLOW, {}, PUSH), reversed_actuation(FLOW, PUSH)
STRATEGY = Reactive(decision_interval_lt=0.25, level=0.25, watch="a1", push="-a2")


def pushed(flows=10):
    return experiment(flows, actuated_system=FORWARD, reversed_system=BACKWARD)


def test_flows_pushed_against_a_mode_are_those_of_a_plain_loop():
    given = pushed()
    flows = run(STRATEGY, given, None, keep_states=True, costs=True)
    timing, seen = flows.timing, set()
    assert flows.controlled_states is not None
    for position, row in enumerate(flows.rows):
        state = given.washouts[row, -1][:, np.newaxis]
        system, forces = FLOW, []
        for now in range(timing.first_look, timing.counted_until):
            if (now - timing.first_look) % 5 == 0:
                a1, a2 = state[:2, 0]
                system = (BACKWARD if a2 > 0 else FORWARD) if a1 >= 0.25 else FLOW
            for _ in range(4):
                state = step(system, state, 0.25)
            np.testing.assert_array_equal(flows.controlled_states[position, now + 1], state[:, 0])
            assert flows.actuated[position, now + 1] == (system is not FLOW)
            seen.add(id(system))
            if now >= timing.counted_from:
                third = state[2, 0] * {id(FORWARD): 0.01, id(BACKWARD): -0.01}.get(id(system), 0.0)
                forces.append((0.01 * (system is not FLOW), abs(third)))
        assert flows.cost is not None
        effort, power = np.mean(forces, axis=0)
        assert flows.cost.effort[position] == pytest.approx(effort, rel=1e-9, abs=1e-15)
        assert flows.cost.power[position] == pytest.approx(power, rel=1e-9, abs=1e-15)
    assert len(seen) == 3


def test_the_energy_input_has_the_work_of_either_force():
    """The whole budget, step by step: dk/dt of the equations that a flow obeys."""
    given = pushed()
    flows = run(STRATEGY, given, None, keep_states=True, costs=True)
    assert flows.controlled_states is not None
    assert flows.controlled_energy is not None
    counted = flows.timing.counted
    states = flows.controlled_states[:, counted].transpose(2, 0, 1)
    free = FLOW.energy_budget(states)
    excess = flows.controlled_energy.input - free.input.mean(axis=1)
    assert flows.cost is not None
    assert (np.abs(excess) <= flows.cost.power + 1e-15).all()
    assert (np.abs(excess) > 0).any()


def test_the_cost_of_a_changed_parameter_is_that_of_the_force_that_does_the_same():
    states = np.random.default_rng(1).normal(0, 0.2, (2, 5, 9))
    actuation = np.array([[0, 1, 1, 0, 1], [0, 0, 0, 0, 0]], dtype=np.uint8)
    found = actuation_cost((FLOW, RAISED), states, actuation)
    assert found is not None
    efforts, powers = [], []
    for state, on in zip(states[0], actuation[0], strict=True):
        force = RAISED.right_hand_side(state) - FLOW.right_hand_side(state)
        efforts.append(on * np.linalg.norm(force))
        powers.append(on * abs(state @ force))
    assert found.effort.tolist() == [pytest.approx(np.mean(efforts)), 0.0]
    assert found.power.tolist() == [pytest.approx(np.mean(powers)), 0.0]
    # the energy changes by that power: dk/dt with the actuation less without it
    budgets = [system.energy_budget(states[0].T) for system in (FLOW, RAISED)]
    rates = [budget.input - budget.dissipation for budget in budgets]
    assert found.power[0] == pytest.approx(np.mean(actuation[0] * np.abs(rates[1] - rates[0])))


def test_a_force_on_a_stiff_flow_has_its_cost():
    flow = KolmogorovFlow(largest_wavenumber=4)
    driven = KolmogorovFlow(largest_wavenumber=4, large_scale_growth=0.2)
    state = flow.sample_initial_states(1, np.random.default_rng(1))[:, 0]
    found = actuation_cost((flow, driven), state[np.newaxis, np.newaxis], np.ones((1, 1), np.uint8))
    large_scale = [flow.component_names.index(name) for name in ("a_1_0", "b_1_0")]
    size = np.linalg.norm(state[large_scale])
    force = 0.2 * (1 - size**2) * size
    assert found.effort[0] == pytest.approx(abs(force))
    assert found.power[0] == pytest.approx(abs(force) * size)


def test_a_map_has_no_equivalent_force():
    class Shift(FlowMap):
        dimension = 1

        def flow_map(self, state, time_step):
            return state

        def observable(self, state):
            return state[0]

    states, actuation = np.zeros((1, 2, 1)), np.ones((1, 2), dtype=np.uint8)
    assert actuation_cost((Shift(), Shift()), states, actuation) is None


def test_by_default_the_observable_is_watched():
    given = experiment(6)
    plain = Reactive(decision_interval_lt=0.25, level=0.05)
    named = replace(plain, watch="observable")
    expected, found = run(plain, given, None), run(named, given, None)
    assert expected.actuated.any()
    assert np.array_equal(found.controlled, expected.controlled)


def test_quantities_are_expressions_of_the_components():
    states = np.random.default_rng(2).normal(size=(9, 4))
    found = quantity("a1 - 2 * a9**2 + observable", FLOW)(states)
    expected = states[0] - 2 * states[8] ** 2 + FLOW.observable(states)
    np.testing.assert_allclose(found, expected)
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
