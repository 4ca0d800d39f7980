"""Plans that may reverse a force: both directions are forecast; equations are never wrong."""

from dataclasses import replace

import numpy as np
import pytest
from test_control_strategies import FLOW, experiment

from burstcast.control.actuation import (
    ActuationValues,
    ActuatorShare,
    actuated_system,
    reversed_actuation,
)
from burstcast.control.strategies.planned import Planned
from burstcast.forecasters.equations import EquationsFromTruth

PUSH = np.array([0.0, 0.0, 0.01, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
STRATEGY = Planned(decision_interval_lt=0.25, horizon_lt=2.0, durations_lt=(0.25, 1.0))
BOTH_WAYS = replace(STRATEGY, reversible=True)
VALUES = ActuationValues((0.0,), (1.0,), (-1.0,))


def simulated(strategy, push, delay_lt=0.0):
    given = experiment(8)
    given = replace(
        given,
        actuated_system=actuated_system(FLOW, {}, push),
        reversed_system=reversed_actuation(FLOW, push) if strategy.reversible else None,
        values=VALUES,
        schedule=replace(given.schedule, delay_lt=delay_lt),
    )
    share = ActuatorShare.of(FLOW, {}, push)
    equations = EquationsFromTruth(FLOW, 0.25, 4, share)
    return strategy.simulate(given, strategy.monitor(given, [equations]), noise=None)


def exceeding(flows):
    return (flows.controlled[:, flows.timing.counted_from + 1 :] >= flows.threshold).sum()


@pytest.mark.parametrize("delay_lt", [0.0, 0.5])
def test_the_sign_of_a_force_that_may_be_reversed_does_not_matter(delay_lt):
    one, other = (simulated(BOTH_WAYS, push, delay_lt) for push in (PUSH, -PUSH))
    np.testing.assert_array_equal(one.controlled, other.controlled)
    np.testing.assert_array_equal(one.actuated, other.actuated)
    assert one.actuated.any()


@pytest.mark.parametrize("delay_lt", [0.0, 0.5])
def test_equations_that_are_told_of_the_direction_are_never_wrong(delay_lt):
    """What the monitor expects under its plan, reversed or not, is what the true flow does."""
    flows = simulated(BOTH_WAYS, PUSH, delay_lt)
    decisions = flows.decisions
    acted = decisions.on & decisions.event_ahead
    np.testing.assert_array_equal(decisions.on & ~decisions.event_ahead, False)
    # a plan of the equations fails only where every plan does: then nothing could be done
    assert acted.any()
    assert (~decisions.plan_fails[acted]).any()


def test_two_directions_leave_no_more_than_one():
    assert exceeding(simulated(BOTH_WAYS, PUSH)) <= min(
        exceeding(simulated(STRATEGY, push)) for push in (PUSH, -PUSH)
    )


def test_only_a_force_is_reversed():
    given = experiment()
    with pytest.raises(ValueError, match="only a force can be reversed"):
        BOTH_WAYS.monitor(given, [])
    reversible = replace(given, reversed_system=reversed_actuation(FLOW, PUSH), values=VALUES)
    equations = EquationsFromTruth(FLOW, 0.25, 4, ActuatorShare.of(FLOW, {}, PUSH))
    with pytest.raises(ValueError, match="cannot vote about the direction"):
        BOTH_WAYS.monitor(reversible, [equations, equations])
