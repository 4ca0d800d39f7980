"""Control by a vote, against members that are asked one by one."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest
from helpers_control import EQUATIONS, FLOW, asked, experiment
from hypothesis import given, settings
from hypothesis import strategies as st
from test_control_strategies import SETTINGS

from burstcast.arrays import FloatArray
from burstcast.control import policy as policy_module
from burstcast.control.controllers import controlling_policy, votes
from burstcast.control.experiment import ControlExperiment
from burstcast.control.policy import Members, Policy
from burstcast.control.strategies.base import ControlStrategy
from burstcast.control.strategies.registry import (
    available_strategies,
    make_strategy,
    strategy_class,
)
from burstcast.forecasters.base import Forecaster
from burstcast.forecasters.equations_filtered import FilteredEquations
from burstcast.forecasters.equations_noisy import EquationsFromObservation
from helpers_forecasters import MadeUpForecaster

VOTING = ("receding_horizon", "prediction_triggered")
NOISE = 0.02


def strategy(name: str, share: float) -> ControlStrategy:
    return make_strategy(name, {**SETTINGS[name], "vote_share": share})


@dataclass(frozen=True)
class Biased(MadeUpForecaster):
    """The equations from a state that is wrong by a factor."""

    factor: float

    def start(self, washout: FloatArray) -> FloatArray:
        return EQUATIONS.start(washout * self.factor)

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        return EQUATIONS.advance(memory, steps)


def committee(
    chosen: ControlStrategy, given: ControlExperiment, forecasters: Sequence[Forecaster]
) -> Policy:
    return controlling_policy("committee", chosen, given, forecasters)


def filtered() -> FilteredEquations:
    return FilteredEquations(EquationsFromObservation(FLOW, 0.25, 4), np.full(9, NOISE), 18, 1.0)


def holds_event(name: str, observable: FloatArray, threshold: float) -> bool:
    """Whether one forecast, step by step, holds an event, for strategies of SETTINGS."""
    if name == "receding_horizon":  # two Lyapunov times of twenty steps
        return any(value >= threshold for value in observable[:40])
    # from step 20, below, up to step 40
    return observable[19] < threshold and any(value >= threshold for value in observable[19:40])


def washouts(flows: int, noise: float = 0.0) -> FloatArray:
    states = experiment(flows).washouts.transpose(1, 2, 0)
    errors = np.random.default_rng(3).normal(scale=noise, size=states.shape)
    return np.ascontiguousarray(states + errors)


def test_the_strategies_that_let_vote() -> None:
    assert tuple(n for n in available_strategies() if votes(strategy_class(n))) == (
        "planned",
        *VOTING[::-1],
    )
    given = experiment(2)
    reactive = make_strategy("reactive", SETTINGS["reactive"])
    with pytest.raises(TypeError, match="Reactive has no vote_share"):
        committee(reactive, given, [EQUATIONS, EQUATIONS])


@pytest.mark.parametrize("name", VOTING)
@pytest.mark.parametrize("share", [0.1, 0.5, 1.0])
def test_a_committee_of_one_is_that_one(name: str, share: float) -> None:
    given = experiment(6)
    chosen = strategy(name, share)
    noise = np.random.default_rng(1).normal(scale=1e-3, size=(6, 200, 9))
    alone = make_strategy(name, SETTINGS[name])
    followed = chosen.simulate(given, committee(chosen, given, [Biased(1.02)]), noise=noise)
    expected = alone.simulate(given, alone.policy(given, Biased(1.02)), noise=noise)
    assert expected.actuated.any()
    np.testing.assert_array_equal(followed.controlled, expected.controlled)
    np.testing.assert_array_equal(followed.actuated, expected.actuated)


@pytest.mark.parametrize("name", VOTING)
def test_networks_vote_by_their_share(name: str) -> None:
    given = replace(experiment(40), threshold=0.05)
    forecasters = [Biased(0.9), Biased(1.0), Biased(1.1), Biased(1.2)]
    washout = washouts(40)
    count = np.zeros(40, dtype=int)
    for one in forecasters:
        for flow in range(40):
            forecast, _ = one.advance(one.start(washout[:, :, flow : flow + 1]), 40)
            observable = FLOW.observable(forecast.transpose(1, 0, 2))[:, 0]
            count[flow] += holds_event(name, observable, 0.05)
    assert len(set(count)) > 2
    for needed in range(1, 5):
        chosen = strategy(name, needed / 4)
        found = asked(committee(chosen, given, forecasters), washout)
        assert found == (count >= needed).tolist()


@pytest.mark.parametrize("name", VOTING)
def test_members_of_a_filter_vote_by_their_share(name: str) -> None:
    """Any, a quarter, half, all of them: against each member of each flow alone."""
    given = replace(experiment(12), threshold=0.05)
    forecaster, washout = filtered(), washouts(12, NOISE)
    count = np.zeros(12, dtype=int)
    for flow in range(12):
        memory = forecaster.ensemble(washout[:, :, flow : flow + 1])
        for member in range(18):
            forecast, _ = forecaster.advance(np.ascontiguousarray(memory[..., member, :]), 40)
            observable = FLOW.observable(forecast.transpose(1, 0, 2))[:, 0]
            count[flow] += holds_event(name, observable, 0.05)
    assert any(0 < votes < 18 for votes in count)
    for share, needed in ((1 / 18, 1), (0.25, 5), (0.5, 9), (1.0, 18)):
        policy = committee(strategy(name, share), given, [forecaster])
        assert asked(policy, washout) == (count >= needed).tolist()


def test_members_of_many_flows_are_asked_a_few_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    given = replace(experiment(12), threshold=0.05)
    policy = committee(strategy("receding_horizon", 0.5), given, [filtered()])
    washout = washouts(12, NOISE)
    together = asked(policy, washout)
    assert 0 < sum(together) < 12
    for few in (1, 5, 12):
        monkeypatch.setattr(policy_module, "FLOWS_PER_CALL", few)
        assert asked(policy, washout) == together
    assert asked(policy, washout[:, :, :0]) == []


@dataclass(frozen=True)
class Listed:
    """Members whose memory is one number each, and whose forecasts stay there."""

    values: FloatArray  # (members, batch)
    aware = False

    def ensemble(self, washout: FloatArray, parameters: FloatArray | None = None) -> FloatArray:
        return self.values[:, : washout.shape[2]]

    def advance(self, memory: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        return np.broadcast_to(memory, (steps, 1, *memory.shape)), memory

    def leave_one_out(self, training, case, washout):  # type: ignore[no-untyped-def]
        raise NotImplementedError


@settings(max_examples=50)
@given(st.data())
def test_memories_without_rows_are_side_by_side_too(data: st.DataObject) -> None:
    """Analogues have one number for each member: nothing before its axis."""
    members, batch = data.draw(st.integers(1, 6)), data.draw(st.integers(1, 5))
    values = np.array(
        data.draw(st.lists(st.integers(0, 9), min_size=members * batch, max_size=members * batch)),
        dtype=np.float64,
    ).reshape(members, batch)
    memory = Members(Listed(values)).start(np.zeros((1, 1, batch)))
    assert memory.tolist() == values.ravel().tolist()
