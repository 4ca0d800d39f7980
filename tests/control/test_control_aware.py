"""Control by forecasters that are told of the actuation, against one plain loop per flow."""

from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np
import pytest
from helpers_control import FLOW, alarms_of, asked, look_at, plain_flow, run
from helpers_control import experiment as turbulent

from burstcast.arrays import BoolArray
from burstcast.control.actuation import (
    ActuationValues,
    ActuatorShare,
    actuated_system,
    reversed_actuation,
)
from burstcast.control.controllers import controlling_policy
from burstcast.control.strategies.planned import Planned, best_plans, pulses
from burstcast.control.strategies.receding_horizon import RecedingHorizon
from burstcast.control.timing import Schedule
from burstcast.forecasters.equations import EquationsFromTruth
from burstcast.forecasters.equations_filtered import FilteredEquations
from burstcast.forecasters.equations_noisy import EquationsFromObservation
from burstcast.forecasters.persistence import Persistence
from burstcast.systems.integration import integrate_switched
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.parameters import SystemParameters
from helpers_library import MadeUpForecaster

WEAK = MoehlisFaisstEckhardt(800.0)
REYNOLDS = SystemParameters.of(FLOW, ["reynolds"])
EQUATIONS = EquationsFromTruth(FLOW, 0.25, 4, REYNOLDS)
THRESHOLD, PER_LT, STRIDE = 0.07, 20, 4
PUSH = np.array([0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
SHARE = ActuatorShare.of(FLOW, {}, PUSH)
RECEDING = RecedingHorizon(decision_interval_lt=0.25, horizon_lt=3.0, aware=True)
PLANNED = Planned(
    decision_interval_lt=0.25,
    horizon_lt=3.0,
    starts_lt=(0.0, 0.25, 0.75),
    durations_lt=(0.25, 0.5, 1.0, 2.0),
)


def schedule(delay_lt: float) -> Schedule:
    return Schedule(5, 2.0, 4.0, delay_lt, -1.0, 1.5, PER_LT, STRIDE, 0.25)


def experiment(flows: int, delay_lt: float = 0.0, **changes: Any) -> Any:
    usual = {"actuated_system": WEAK, "values": ActuationValues((400.0,), (800.0,))}
    return turbulent(flows, schedule(delay_lt), **(usual | changes))


def heights(systems: Any, state: Any, plans: Any) -> Any:
    """Observable after each step under several actuations to come, one after the other."""
    choice = np.repeat(np.array(plans, dtype=np.uint8).T, STRIDE, axis=0)
    start = np.repeat(state, len(plans), axis=1)
    states = integrate_switched(systems, choice, start, 0.25, STRIDE)[1:]
    return FLOW.observable(states.transpose(1, 0, 2)).T.tolist()


def plain_decision(strategy: Any, given: Any, state: Any, pending: list[int]) -> int:
    """What to do from a true state on, by the equations."""
    timing, level = given.schedule, given.threshold - strategy.margin
    delay, horizon = len(pending), strategy.horizon(timing)
    none = [0] * (horizon - delay)
    decided = max(heights(given.systems, state, [pending + none])[0][delay:]) >= level
    if not (decided and isinstance(strategy, Planned)):
        return int(decided)
    pairs = product(strategy.starts_lt, strategy.durations_lt)
    spans = [(timing.steps(one), timing.steps(two)) for one, two in pairs]
    plans = [
        [kind * (first <= number < first + length) for number in range(horizon - delay)]
        for kind in ((1, 2) if strategy.reversible else (1,))
        for first, length in spans
    ]
    choices = []
    seen_under = heights(given.systems, state, [pending + plan for plan in plans])
    for plan, seen in zip(plans, seen_under, strict=True):
        above, peak = sum(one >= level for one in seen[delay:]), max(seen[delay:])
        cost = sum(map(bool, plan))
        choices.append(((0, cost, peak) if above == 0 else (1, above, peak, cost), plan))
    return min(choices, key=lambda choice: choice[0])[1][0]


@pytest.mark.parametrize("delay_lt", [0.0, 0.6])
@pytest.mark.parametrize(
    "strategy",
    [RECEDING, PLANNED, replace(PLANNED, margin=0.01), replace(PLANNED, reversible=True)],
)
def test_flows_are_those_of_a_plain_loop(strategy: Any, delay_lt: float) -> None:
    """Decisions every quarter of a Lyapunov time; the delay is no multiple of it."""
    given, equations = experiment(6, delay_lt), EQUATIONS
    if getattr(strategy, "reversible", False):
        changes = {"actuated_system": actuated_system(FLOW, {}, PUSH)}
        changes["reversed_system"] = reversed_actuation(FLOW, PUSH)
        values = ActuationValues((0.0,), (1.0,), (-1.0,))
        given = replace(given, values=values, **changes)
        equations = EquationsFromTruth(FLOW, 0.25, 4, SHARE)
    flows = run(strategy, given, equations)
    timing, alarms = flows.timing, alarms_of(flows)
    delay = given.schedule.steps(delay_lt)
    assert len(flows) > 1
    for position, row in enumerate(flows.rows):
        # what was decided so far, by the step from which it acts
        acting = [0] * (timing.length + delay + 6)

        def decide(number: int, state: Any, acting: list[int] = acting) -> int:
            now = timing.first_look + 5 * number
            decided = plain_decision(strategy, given, state, acting[now : now + delay])
            acting[now + delay : now + delay + 5] = [decided] * 5
            return decided

        plain = plain_flow(given, row, timing, decide)
        np.testing.assert_allclose(flows.controlled[position], plain.heights[: timing.length])
        assert alarms[position] == [look.alarm for look in plain.looks]
        into_step = plain.acting[STRIDE - 1 :: STRIDE][: timing.length - 1]
        assert flows.actuated[position, 1:].tolist() == [bool(number) for number in into_step]
    assert flows.looks.alarm.any()
    assert not flows.looks.alarm.all()


def test_who_knows_what_is_on_its_way_acts_less():
    """With a delay of one Lyapunov time, and as little left."""
    given = experiment(60, 1.0)
    free = RecedingHorizon(decision_interval_lt=0.25, horizon_lt=3.0)
    planned = replace(PLANNED, horizon_lt=4.0)
    spent, left = {}, {}
    for name, strategy in (("free", free), ("aware", RECEDING), ("planned", planned)):
        flows = run(strategy, given, EQUATIONS)
        counted = flows.timing.counted
        spent[name] = flows.actuated[:, counted].mean()
        left[name] = (flows.controlled[:, counted] >= THRESHOLD).mean()
    assert spent["planned"] < spent["aware"] < spent["free"]
    assert left["aware"] <= left["free"] + 0.01
    assert left["planned"] <= left["free"] + 0.01


@dataclass(frozen=True)
class Scripted(MadeUpForecaster):
    """Heights that depend on how long the actuator has been on: ``table[plan's first steps]``."""

    heights: dict[str, list[float]]
    aware = True

    def start(self, washout, parameters=None):
        return washout[-1]

    def advance(self, memory, steps, parameters=None):
        outputs = np.empty((steps, 1, memory.shape[1]))
        for flow in range(memory.shape[1]):
            plan = "".join("1" if on else "0" for on in parameters[:, 0, flow])
            outputs[:, 0, flow] = self.heights[plan]
        return outputs, memory


def decided(table: dict[str, list[float]], plans: BoolArray) -> tuple[bool, str]:
    look = look_at(np.zeros((2, 1, 1)))
    values = ActuationValues((0.0,), (1.0,))
    chosen = best_plans(look, Scripted(table), values, lambda state: state[0], 1.0, plans)
    return bool(chosen[0, 0]), "".join("1" if on else "0" for on in chosen[:, 0])


EVENT, SMALL, LARGE = [0.5, 0.9, 2.0], [0.5, 0.8, 0.9], [0.5, 0.6, 0.7]


@pytest.mark.parametrize(
    ("outcomes", "expected"),
    [
        # no event without any actuation: nothing is planned
        ({"000": SMALL}, (False, "000")),
        # the shortest that suffices, and of two the one with the lower peak
        ({"100": SMALL, "010": LARGE, "110": LARGE}, (False, "010")),
        ({"100": LARGE, "010": SMALL, "110": LARGE}, (True, "100")),
        ({"100": EVENT, "010": EVENT, "110": SMALL}, (True, "110")),
        # none suffices: the least time above the level, then the lowest peak, then the cheapest
        ({"100": [2.0, 2.0, 0.1], "010": [3.0, 0.1, 0.1], "110": [2.0, 2.0, 2.0]}, (False, "010")),
        ({"100": [2.0, 0.1, 0.1], "010": [3.0, 0.1, 0.1], "110": [1.5, 0.1, 0.1]}, (True, "110")),
        ({"100": EVENT, "010": [2.0, 2.0, 0.1], "110": EVENT}, (True, "100")),
        # a forecast under a plan that is lost cannot be trusted
        ({"100": [0.1, np.nan, 0.1], "010": EVENT, "110": SMALL}, (True, "110")),
        # one without actuation that is lost forecasts nothing
        ({"000": [0.1, np.nan, np.inf]}, (False, "000")),
    ],
)
def test_the_cheapest_plan_that_suffices_is_taken(outcomes, expected):
    table = {"000": EVENT, "100": EVENT, "010": EVENT, "110": EVENT, **outcomes}
    assert decided(table, pulses([0, 1], [1, 2], 3)[[0, 2, 1]]) == expected


def test_pulses_are_cut_at_the_horizon_and_no_two_are_alike():
    found = pulses([0, 2], [1, 2, 9], 4)
    assert ["".join("01"[on] for on in plan.astype(int)) for plan in found] == [
        "1000",
        "1100",
        "1111",
        "0010",
        "0011",
    ]


@pytest.mark.parametrize("strategy", [RECEDING, PLANNED])
def test_members_and_committees_vote_under_the_actuation(strategy):
    """The members of a filter one by one, and several forecasters one by one."""
    given = experiment(12, 0.25)
    generator = np.random.default_rng(3)
    washout = given.washouts.transpose(1, 2, 0) + generator.normal(0, 0.02, (5, 9, 12))
    acting = generator.random((4 + 5, 12)) < 0.5
    filtered = FilteredEquations(
        EquationsFromObservation(FLOW, 0.25, 4, REYNOLDS), np.full(9, 0.02), 18, 1.0
    )

    @dataclass(frozen=True)
    class Member(MadeUpForecaster):
        number: int
        aware = True

        def start(self, washout, parameters=None):
            return np.ascontiguousarray(filtered.ensemble(washout, parameters)[:, self.number])

        def advance(self, memory, steps, parameters=None):
            return filtered.advance(memory, steps, parameters)

    alone = [asked(strategy.policy(given, Member(number)), washout, acting) for number in range(18)]
    for share in (0.1, 0.5, 0.9):
        chosen = replace(strategy, vote_share=share)
        expected = (np.sum(alone, axis=0) >= share * 18).tolist()
        assert (
            asked(controlling_policy("committee", chosen, given, [filtered]), washout, acting)
            == expected
        )
        many = [Member(number) for number in range(18)]
        assert (
            asked(controlling_policy("committee", chosen, given, many), washout, acting) == expected
        )
    assert 0 < np.sum(alone) < 18 * 12


@pytest.mark.parametrize("strategy", [RECEDING, PLANNED])
def test_who_cannot_be_told_is_refused(strategy: Any) -> None:
    given = experiment(2)
    with pytest.raises(ValueError, match="Persistence does not know the parameters"):
        strategy.policy(given, Persistence())
    with pytest.raises(ValueError, match="no parameter for forecasters"):
        strategy.policy(replace(given, values=None), EQUATIONS)


def pushed(strategy: Any, push: Any, delay_lt: float = 0.0) -> Any:
    given = experiment(
        8,
        delay_lt,
        actuated_system=actuated_system(FLOW, {}, push),
        reversed_system=reversed_actuation(FLOW, push) if strategy.reversible else None,
        values=ActuationValues((0.0,), (1.0,), (-1.0,)),
    )
    share = ActuatorShare.of(FLOW, {}, push)
    return run(strategy, given, EquationsFromTruth(FLOW, 0.25, 4, share))


ONE_WAY = replace(PLANNED, horizon_lt=2.0, durations_lt=(0.25, 1.0))
BOTH_WAYS = replace(ONE_WAY, reversible=True)


@pytest.mark.parametrize("delay_lt", [0.0, 0.5])
def test_the_sign_of_a_force_that_may_be_reversed_does_not_matter(delay_lt: float) -> None:
    one, other = (pushed(BOTH_WAYS, push, delay_lt) for push in (PUSH, -PUSH))
    np.testing.assert_array_equal(one.controlled, other.controlled)
    np.testing.assert_array_equal(one.actuated, other.actuated)
    assert one.actuated.any()


def test_two_directions_leave_no_more_than_one() -> None:
    def exceeding(flows: Any) -> int:
        return (flows.controlled[:, flows.timing.counted] >= flows.threshold).sum()

    least = min(exceeding(pushed(ONE_WAY, push)) for push in (PUSH, -PUSH))
    assert exceeding(pushed(BOTH_WAYS, PUSH)) <= least


def test_only_a_force_is_reversed() -> None:
    given = experiment(2)
    with pytest.raises(ValueError, match="only a force can be reversed"):
        BOTH_WAYS.policy(given, EQUATIONS)
    reversible = replace(given, reversed_system=reversed_actuation(FLOW, PUSH))
    with pytest.raises(ValueError, match="cannot vote about the direction"):
        controlling_policy("committee", BOTH_WAYS, reversible, [EQUATIONS, EQUATIONS])


def test_plans_may_last_one_step_and_fill_the_horizon():
    steps = 3 * PER_LT
    one = replace(PLANNED, durations_lt=(1 / PER_LT, 3.0))
    found = one.plans(schedule(0.0))
    assert found.shape == (6 - 2 + 2, steps)  # later starts are cut, each to a plan of its own
    assert found.sum(axis=1).min() == 1
    assert found.sum(axis=1).max() == steps


def test_a_horizon_that_ends_before_a_decision_takes_effect_is_refused():
    strategy = replace(PLANNED, horizon_lt=0.5)
    with pytest.raises(ValueError, match=r"0\.5 .* does not reach beyond the delay of 0\.5"):
        strategy.policy(experiment(2, delay_lt=0.5), EQUATIONS)
