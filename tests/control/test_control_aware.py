"""Control by forecasters that are told of the actuation, against one plain loop per flow."""

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import pytest
from helpers_control import (
    EQUATIONS,
    FLOW,
    REYNOLDS,
    STEPS,
    alarms_of,
    asked,
    look_at,
    plain_flow,
    run,
)
from helpers_control import experiment as turbulent
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.control import policy as policy_module
from burstcast.control.actuation import (
    ActuationValues,
    ActuatorShare,
    actuated_system,
    reversed_actuation,
)
from burstcast.control.controllers import controlling_policy
from burstcast.control.strategies.planned import Planned, best_plans, pulses
from burstcast.control.strategies.prediction_triggered import PredictionTriggered
from burstcast.control.strategies.receding_horizon import RecedingHorizon
from burstcast.control.timing import Schedule
from burstcast.forecasters.equations import EquationsFromTruth
from burstcast.forecasters.equations_filtered import FilteredEquations
from burstcast.forecasters.equations_noisy import EquationsFromObservation
from burstcast.forecasters.persistence import Persistence
from burstcast.systems.integration import integrate_switched
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from helpers_library import MadeUpForecaster

WEAK = MoehlisFaisstEckhardt(800.0)
PER_LT, STRIDE = 20, 4
PUSH = np.array([0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
SHARE = ActuatorShare.of(FLOW, {}, PUSH)
RECEDING = RecedingHorizon(decision_interval_lt=0.25, horizon_lt=3.0, aware=True)
PLANNED = Planned(
    decision_interval_lt=0.25,
    horizon_lt=3.0,
    starts_lt=(0.0, 0.25, 0.75),
    durations_lt=(0.25, 0.5, 1.0, 2.0),
)


def schedule(delay_lt):
    return Schedule(5, 2.0, 4.0, delay_lt, -1.0, 1.5, PER_LT, STRIDE, 0.25)


def experiment(flows, delay_lt=0.0, **changes):
    usual = {"actuated_system": WEAK, "values": ActuationValues((400.0,), (800.0,))}
    return turbulent(flows, schedule(delay_lt), **(usual | changes))


def heights(systems, state, plans):
    """Observable after each step under several actuations to come, one after the other."""
    choice = np.repeat(np.array(plans, dtype=np.uint8).T, STRIDE, axis=0)
    start = np.repeat(state, len(plans), axis=1)
    states = integrate_switched(systems, choice, start, 0.25, STRIDE)[1:]
    return FLOW.observable(states.transpose(1, 0, 2)).T.tolist()


def plain_decision(strategy, given, state, pending):
    """What to do from a true state on, by the equations."""
    timing, level = given.schedule, given.threshold - strategy.margin
    delay, horizon = len(pending), strategy.horizon(timing)
    none = [0] * (horizon - delay)
    decided = max(heights(given.systems, state, [pending + none])[0][delay:]) >= level
    if not (decided and isinstance(strategy, Planned)):
        return int(decided)
    pairs = product(strategy.starts_lt, strategy.durations_lt)
    spans = [(timing.steps(start), timing.steps(duration)) for start, duration in pairs]
    plans = [
        [kind * (first <= number < first + length) for number in range(horizon - delay)]
        for kind in ((1, 2) if strategy.reversible else (1,))
        for first, length in spans
    ]
    seen_under = heights(given.systems, state, [pending + plan for plan in plans])
    return cheapest(plans, [seen[delay:] for seen in seen_under], level)[0]


def cheapest(plans, seen_under, level):
    """Of plans that suffice the cheapest, else that of the least time at or above the level."""
    choices = []
    for plan, seen in zip(plans, seen_under, strict=True):
        # a forecast that is lost cannot be trusted
        trusted = [height if np.isfinite(height) else np.inf for height in seen]
        above, peak = sum(height >= level for height in trusted), max(trusted)
        cost = sum(map(bool, plan))
        choices.append(((0, cost, peak) if above == 0 else (1, above, peak, cost), plan))
    return min(choices, key=lambda choice: choice[0])[1]


@pytest.mark.parametrize("delay_lt", [0.0, 0.6])
@pytest.mark.parametrize(
    "strategy",
    [RECEDING, PLANNED, replace(PLANNED, margin=0.01), replace(PLANNED, reversible=True)],
)
def test_flows_are_those_of_a_plain_loop(strategy, delay_lt):
    """Decisions every quarter of a Lyapunov time; the delay is no multiple of it."""
    given, equations = experiment(3, delay_lt), EQUATIONS
    if getattr(strategy, "reversible", False):
        changes = {"actuated_system": actuated_system(FLOW, {}, PUSH)}
        changes["reversed_system"] = reversed_actuation(FLOW, PUSH)
        values = ActuationValues((0.0,), (1.0,), (-1.0,))
        given = replace(given, values=values, **changes)
        equations = EquationsFromTruth(system=FLOW, in_force=SHARE, **STEPS)
    flows = run(strategy, given, equations)
    timing, alarms = flows.timing, alarms_of(flows)
    delay = given.schedule.steps(delay_lt)
    assert len(flows) > 1
    for position, row in enumerate(flows.rows):
        # what was decided so far, by the step from which it acts
        acting = [0] * (timing.length + delay + 6)

        def decide(number, state, acting=acting):
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


@dataclass(frozen=True)
class Scripted(MadeUpForecaster):
    """Heights that depend on when the actuator is on."""

    heights: dict[str, list[float]]
    aware = True

    def start(self, washout):
        return washout[-1, :1]

    def advance(self, memory, steps):
        outputs = np.empty((steps, 1, memory.shape[1]))
        for flow in range(memory.shape[1]):
            plan = memory[1:, flow].astype(int).tolist()
            outputs[:, 0, flow] = self.heights[str(plan)]
        return outputs, memory[:1]


HEIGHTS = st.lists(st.sampled_from([0.1, 0.9, 1.0, 2.0, np.nan, np.inf]), min_size=3, max_size=3)
PLANS = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]


@settings(max_examples=100, deadline=None)
@given(st.lists(HEIGHTS, min_size=4, max_size=4))
def test_best_plans_are_the_cheapest_that_suffice(outcomes):
    """None where no event is forecast without actuation, or that forecast is invalid."""
    forecaster = Scripted(dict(zip(map(str, PLANS), outcomes, strict=True)))
    look, values = look_at(np.zeros((2, 1, 1))), ActuationValues((0.0,), (1.0,))
    plans = np.array(PLANS[1:], dtype=np.uint8)
    plan, invalid = best_plans(look, forecaster, values, lambda state: state[0], 1.0, plans)
    assert invalid.tolist() == [not np.isfinite(outcomes[0]).all()]
    event = not invalid[0] and any(height >= 1.0 for height in outcomes[0])
    # once it is invalid, a forecast stays so
    lost = [np.logical_or.accumulate(~np.isfinite(of_plan)) for of_plan in outcomes]
    heights = np.where(lost, np.nan, outcomes).tolist()
    expected = cheapest(PLANS[1:], heights[1:], 1.0) if event else PLANS[0]
    assert plan[:, 0].tolist() == expected


def test_pulses_are_cut_at_the_horizon_and_no_two_are_alike():
    plans = pulses([0, 2], [1, 2, 9], 4)
    shown = " ".join("".join("01"[on] for on in plan.astype(int)) for plan in plans)
    assert shown == "1000 1100 1111 0010 0011"


@pytest.mark.parametrize(
    ("strategy", "threshold"),
    [
        *((RECEDING, 0.07), (PLANNED, 0.07), (replace(RECEDING, aware=False), 0.07)),
        (PredictionTriggered(1.0, 1.0), 0.05),
    ],
)
def test_members_and_committees_vote(strategy, threshold, monkeypatch):
    """The members of a filter one by one, several forecasters one by one, and flows in batches."""
    given = experiment(12, 0.25, threshold=threshold)
    generator = np.random.default_rng(3)
    washout = given.washouts.transpose(1, 2, 0) + generator.normal(0, 0.02, (5, 9, 12))
    acting = generator.random((4 + 5, 12)) < 0.5
    model = EquationsFromObservation(system=FLOW, in_force=REYNOLDS, **STEPS)
    filtered = FilteredEquations(members=18, model=model, errors=np.full(9, 0.02))

    @dataclass(frozen=True)
    class Member(MadeUpForecaster):
        number: int
        aware = True

        def start(self, washout):
            return np.ascontiguousarray(filtered.ensemble(washout)[:, self.number])

        def advance(self, memory, steps):
            return filtered.advance(memory, steps)

    many = [Member(number) for number in range(18)]
    alone = [asked(strategy.policy(given, member), washout, acting) for member in many]
    assert 0 < np.sum(alone) < 18 * 12
    for few, share in ((1, 1 / 18), (5, 0.1), (12, 0.5), (64, 0.9), (64, 1.0)):
        monkeypatch.setattr(policy_module, "FLOWS_PER_CALL", few)
        chosen = replace(strategy, vote_share=share)
        expected = (np.sum(alone, axis=0) >= share * 18).tolist()
        for forecasters in (many, [filtered]):
            policy = controlling_policy("committee", chosen, given, forecasters)
            assert asked(policy, washout, acting) == expected
    assert asked(policy, washout[..., :0], acting[:, :0]) == []


@pytest.mark.parametrize("strategy", [RECEDING, PLANNED])
def test_a_policy_without_what_it_must_be_told_is_refused(strategy):
    given, late = experiment(2), experiment(2, delay_lt=0.5)
    with pytest.raises(ValueError, match="Persistence does not know the parameters"):
        strategy.policy(given, Persistence())
    with pytest.raises(ValueError, match="no parameter for forecasters"):
        strategy.policy(replace(given, values=None), EQUATIONS)
    with pytest.raises(ValueError, match=r"0\.5 .* does not reach beyond the delay of 0\.5"):
        replace(strategy, horizon_lt=0.5).policy(late, EQUATIONS)


def test_only_a_force_is_reversed_and_by_one_forecaster():
    given, both_ways = experiment(2), replace(PLANNED, reversible=True)
    with pytest.raises(ValueError, match="only a force can be reversed"):
        both_ways.policy(given, EQUATIONS)
    reversible = replace(given, reversed_system=reversed_actuation(FLOW, PUSH))
    with pytest.raises(ValueError, match="cannot vote about the direction"):
        controlling_policy("committee", both_ways, reversible, [EQUATIONS, EQUATIONS])
