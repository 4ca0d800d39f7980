"""Control by forecasters that are told of the actuation, against one plain loop per flow."""

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import pytest
from helpers_control import turbulent_washouts

from burstcast.arrays import BoolArray, FloatArray
from burstcast.control.actuation import ActuationValues, ActuatorShare
from burstcast.control.controllers.registry import controlling_monitor
from burstcast.control.experiment import ControlExperiment, Schedule
from burstcast.control.monitors.planned import PlannedMonitor
from burstcast.control.sampled.planning import pulses
from burstcast.control.strategies.planned import Planned
from burstcast.control.strategies.receding_horizon import RecedingHorizon
from burstcast.forecasters.base import Forecaster
from burstcast.forecasters.equations import EquationsFromTruth
from burstcast.forecasters.equations_filtered import FilteredEquations
from burstcast.forecasters.equations_noisy import EquationsFromObservation
from burstcast.forecasters.persistence import Persistence
from burstcast.systems.integration import integrate_switched
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from burstcast.systems.parameters import SystemParameters
from burstcast.systems.runge_kutta import step
from helpers_forecasters import MadeUpForecaster

FREE, WEAK = MoehlisFaisstEckhardt(400.0), MoehlisFaisstEckhardt(800.0)
REYNOLDS = SystemParameters.of(FREE, ["reynolds"])
EQUATIONS = EquationsFromTruth(FREE, 0.25, 4, REYNOLDS)
THRESHOLD, PER_LT, STRIDE = 0.07, 20, 4
RECEDING = RecedingHorizon(decision_interval_lt=0.25, horizon_lt=3.0, aware=True)
PLANNED = Planned(
    decision_interval_lt=0.25,
    horizon_lt=3.0,
    starts_lt=(0.0, 0.25, 0.75),
    durations_lt=(0.25, 0.5, 1.0, 2.0),
)


def schedule(delay_lt: float) -> Schedule:
    return Schedule(5, 2.0, 4.0, delay_lt, -1.0, 1.5, PER_LT, STRIDE, 0.25)


def experiment(flows: int, delay_lt: float = 0.0) -> ControlExperiment:
    given = schedule(delay_lt)
    return ControlExperiment(
        system=FREE,
        actuated_system=WEAK,
        threshold=THRESHOLD,
        series=range(10, 10 + flows),
        washouts=turbulent_washouts(FREE, flows, RECEDING.timing(given)),
        quiet_starts=True,
        schedule=given,
        root_seed=7,
        case="Re400",
        values=ActuationValues((400.0,), (800.0,)),
    )


def heights(state: FloatArray, plans: list[list[bool]]) -> list[list[float]]:
    """Observable after each step under several actuations to come, one after the other."""
    choice = np.repeat(np.array(plans, dtype=np.uint8).T, STRIDE, axis=0)
    start = np.repeat(state, len(plans), axis=1)
    states = integrate_switched((FREE, WEAK), choice, start, 0.25, STRIDE)[1:]
    return FREE.observable(states.transpose(1, 0, 2)).T.tolist()


def plain_control(strategy, given, washout):
    """One flow: the states, decisions, and truths of a loop without any batch."""
    timing = strategy.timing(given.schedule)
    delay, interval, horizon = timing.delay, timing.interval, strategy.horizon(timing)
    state = washout[-1][:, np.newaxis]
    acting = [False] * (timing.counted_until + delay + interval + horizon + 1)
    reached, on, ahead, fails = [float(FREE.observable(state)[0])], [], [], []
    level = given.threshold - strategy.margin
    for now in range(timing.first_forecast, timing.counted_until):
        if (now - timing.first_forecast) % interval == 0 and now + delay < timing.counted_until:
            pending = acting[now : now + delay]
            none = [False] * (horizon - delay)
            off, best = heights(state, [pending + none])[0][delay:], none
            decided = max(off) >= level
            if decided and isinstance(strategy, Planned):
                pairs = product(strategy.starts_lt, strategy.durations_lt)
                spans = [(timing.steps(one), timing.steps(two)) for one, two in pairs]
                plans = [
                    [first <= number < first + length for number in range(horizon - delay)]
                    for first, length in spans
                ]
                choices = []
                for plan, seen in zip(
                    plans, heights(state, [pending + plan for plan in plans]), strict=True
                ):
                    above, peak = sum(one >= level for one in seen[delay:]), max(seen[delay:])
                    cost = sum(plan)
                    choices.append(
                        ((0, cost, peak) if above == 0 else (1, above, peak, cost), plan)
                    )
                best = min(choices, key=lambda choice: choice[0])[1]
                decided = best[0]
            on.append(decided)
            ahead.append(max(off) >= given.threshold)
            under_plan = heights(state, [pending + best])[0][delay:]
            fails.append(max(under_plan) >= given.threshold)
            acting[now + delay : now + delay + interval] = [decided] * interval
        state = state.copy()
        for _ in range(STRIDE):
            state = step(WEAK if acting[now] else FREE, state, 0.25)
        reached.append(float(FREE.observable(state)[0]))
    return reached, on, ahead, fails, acting


@pytest.mark.parametrize("delay_lt", [0.0, 0.6])
@pytest.mark.parametrize("strategy", [RECEDING, PLANNED, replace(PLANNED, margin=0.01)])
def test_flows_are_those_of_a_plain_loop(strategy, delay_lt):
    """Decisions every quarter of a Lyapunov time; the delay is no multiple of it."""
    given = experiment(6, delay_lt)
    flows = strategy.simulate(given, strategy.monitor(given, [EQUATIONS]), noise=None)
    first = flows.timing.first_forecast
    assert len(flows) > 1
    for position, row in enumerate(flows.rows):
        reached, on, ahead, fails, acting = plain_control(strategy, given, given.washouts[row])
        np.testing.assert_allclose(flows.controlled[position, first:], reached, rtol=1e-12)
        assert flows.decisions.on[position].tolist() == on
        assert flows.decisions.event_ahead[position].tolist() == ahead
        expected = acting[first : flows.timing.counted_until]
        assert flows.actuated[position, first + 1 :].tolist() == expected
        if strategy is not RECEDING:
            assert flows.decisions.plan_fails[position].tolist() == fails
    assert flows.decisions.on.any()
    assert not flows.decisions.on.all()
    assert (flows.decisions.plan_fails is None) == (strategy is RECEDING)


def test_told_equations_act_just_where_there_would_be_an_event():
    given = experiment(14, 0.6)
    flows = RECEDING.simulate(given, RECEDING.monitor(given, [EQUATIONS]), noise=None)
    assert np.array_equal(flows.decisions.on, flows.decisions.event_ahead)


def test_who_knows_what_is_on_its_way_acts_less():
    """With a delay of one Lyapunov time, and as little left."""
    given = experiment(60, 1.0)
    free = RecedingHorizon(decision_interval_lt=0.25, horizon_lt=3.0)
    planned = replace(PLANNED, horizon_lt=4.0)
    spent, left = {}, {}
    for name, strategy in (("free", free), ("aware", RECEDING), ("planned", planned)):
        flows = strategy.simulate(given, strategy.monitor(given, [EQUATIONS]), noise=None)
        counted = slice(flows.timing.counted_from + 1, None)
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


def decided(table: dict[str, list[float]], plans: BoolArray):
    monitor = PlannedMonitor(
        Scripted(table), lambda state: state[0], 1.0, ActuationValues((0.0,), (1.0,)), plans
    )
    rows = np.zeros(1, dtype=np.int64)
    washout, acting = np.zeros((2, 1, 1)), np.zeros((1, 1), dtype=bool)
    decision = monitor.decide(rows, rows, washout, acting)
    plan = "".join("1" if on else "0" for on in decision.plan[:, 0])
    assert monitor.alarms(rows, rows, washout, acting).tolist() == decision.alarm.tolist()
    return bool(decision.alarm[0]), plan


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


def asked(monitor, washout, acting):
    rows = np.arange(washout.shape[2])
    return monitor.alarms(rows, np.zeros_like(rows), washout, acting).tolist()


@pytest.mark.parametrize("strategy", [RECEDING, PLANNED])
def test_members_and_committees_vote_under_the_actuation(strategy):
    """The members of a filter one by one, and several forecasters one by one."""
    given = experiment(12, 0.25)
    generator = np.random.default_rng(3)
    washout = given.washouts.transpose(1, 2, 0) + generator.normal(0, 0.02, (5, 9, 12))
    acting = generator.random((4 + 5, 12)) < 0.5
    filtered = FilteredEquations(
        EquationsFromObservation(FREE, 0.25, 4, REYNOLDS), np.full(9, 0.02), 18, 1.0
    )

    @dataclass(frozen=True)
    class Member(MadeUpForecaster):
        number: int
        aware = True

        def start(self, washout, parameters=None):
            return np.ascontiguousarray(filtered.ensemble(washout, parameters)[:, self.number])

        def advance(self, memory, steps, parameters=None):
            return filtered.advance(memory, steps, parameters)

    alone = [
        asked(strategy.monitor(given, [Member(number)]), washout, acting) for number in range(18)
    ]
    for share in (0.1, 0.5, 0.9):
        chosen = replace(strategy, vote_share=share)
        expected = (np.sum(alone, axis=0) >= share * 18).tolist()
        assert (
            asked(controlling_monitor("committee", chosen, given, [filtered]), washout, acting)
            == expected
        )
        many = [Member(number) for number in range(18)]
        assert (
            asked(controlling_monitor("committee", chosen, given, many), washout, acting)
            == expected
        )
    assert 0 < np.sum(alone) < 18 * 12


@pytest.mark.parametrize("strategy", [RECEDING, PLANNED])
def test_who_cannot_be_told_is_refused(strategy):
    given = experiment(2)
    with pytest.raises(ValueError, match="Persistence does not know the parameters"):
        strategy.monitor(given, [Persistence()])
    with pytest.raises(ValueError, match="no parameter for forecasters"):
        strategy.monitor(replace(given, values=None), [EQUATIONS])
    monitor = strategy.monitor(given, [EQUATIONS])
    rows = np.zeros(1, dtype=np.int64)
    with pytest.raises(ValueError, match="the actuation, which is unknown"):
        monitor.alarms(rows, rows, np.zeros((5, 9, 1)))


def test_a_force_is_planned_by_its_share():
    """The parameter is the share of an actuator that is a force."""
    force = [0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    share = ActuatorShare.of(FREE, {}, force)
    equations: Forecaster = EquationsFromTruth(FREE, 0.25, 4, share)
    given = replace(
        experiment(10),
        actuated_system=share.system([1.0]),
        values=ActuationValues((0.0,), (1.0,)),
    )
    flows = RECEDING.simulate(given, RECEDING.monitor(given, [equations]), noise=None)
    assert flows.decisions.on.any()
    assert np.array_equal(flows.decisions.on, flows.decisions.event_ahead)


def test_plans_may_last_one_step_and_fill_the_horizon():
    steps = 3 * PER_LT
    one = replace(PLANNED, durations_lt=(1 / PER_LT, 3.0))
    found = one.sequences(one.timing(schedule(0.0)))
    assert found.shape == (6 - 2 + 2, steps)  # later starts are cut, each to a plan of its own
    assert found.sum(axis=1).min() == 1
    assert found.sum(axis=1).max() == steps


def test_a_horizon_that_ends_before_a_decision_takes_effect_is_refused():
    strategy = replace(PLANNED, horizon_lt=0.5)
    with pytest.raises(ValueError, match=r"0\.5 .* does not reach beyond the delay of 0\.5"):
        strategy.monitor(experiment(2, delay_lt=0.5), [EQUATIONS])
