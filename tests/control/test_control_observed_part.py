"""Control by monitors that observe a part of the state."""

import dataclasses

import numpy as np
import pytest
from test_control_strategies import EQUATIONS, FLOW, experiment

from burstcast.control.strategies.reactive import Reactive
from burstcast.control.strategies.receding_horizon import RecedingHorizon
from burstcast.observation.part import ObservedPart

PART = ObservedPart.of(FLOW, ["a1", "mean = (a1 + a9) / 2"], "observable")
WHOLE = ObservedPart.of(FLOW, [f"a{number}" for number in range(1, 10)], "observable")


def test_a_part_has_its_quantities_and_the_observable():
    states = np.random.default_rng(1).normal(size=(9, 3, 2))
    seen = PART(states)
    np.testing.assert_array_equal(seen[0], states[0])
    np.testing.assert_allclose(seen[1], (states[0] + states[8]) / 2)
    np.testing.assert_array_equal(seen[2], FLOW.observable(states))
    np.testing.assert_array_equal(PART.space.observable(seen), seen[2])


def test_a_quantity_of_an_unknown_component_is_refused():
    with pytest.raises(ValueError, match="no column 'a12'"):
        ObservedPart.of(FLOW, ["a12"], "observable")


def flows_of(strategy, given, forecasters=(), noise=None):
    monitor = strategy.monitor(given, list(forecasters))
    return strategy.simulate(given, monitor, noise=noise)


def test_a_rule_acts_on_what_is_observed_alone():
    given = experiment()
    seen = dataclasses.replace(given, sensor=PART)
    by_part = Reactive(decision_interval_lt=0.2, level=0.3, watch="2 * mean - a1")
    by_all = Reactive(decision_interval_lt=0.2, level=0.3, watch="a9")
    one, other = flows_of(by_part, seen), flows_of(by_all, given)
    np.testing.assert_array_equal(one.actuated, other.actuated)
    np.testing.assert_array_equal(one.controlled, other.controlled)
    with pytest.raises(ValueError, match="unknown name 'a9'"):
        dataclasses.replace(by_all).monitor(seen, [])


def test_noise_is_that_of_what_is_observed():
    given = dataclasses.replace(experiment(), sensor=PART)
    rule = Reactive(decision_interval_lt=0.2, level=0.3, watch="a1")
    length = rule.timing(given.schedule).length
    silence = np.zeros((len(given.series), length, 3))
    np.testing.assert_array_equal(
        flows_of(rule, given, noise=silence).actuated, flows_of(rule, given).actuated
    )
    with pytest.raises(ValueError, match=r"the shape \(\d+, \d+ or more, 3\)"):
        flows_of(rule, given, noise=np.zeros((len(given.series), length, 9)))


class WholeSeen:
    """The equations, given all components and the observable after them."""

    sees_truth = aware = provides_ensemble = False

    def start(self, washout):
        return EQUATIONS.start(np.ascontiguousarray(washout[:, :9]))

    def advance(self, memory, steps):
        outputs, memory = EQUATIONS.advance(memory, steps)
        observable = FLOW.observable(outputs.transpose(1, 0, 2))
        return np.concatenate([outputs, observable[:, np.newaxis]], axis=1), memory


def test_forecasts_of_the_observed_components_control_as_those_of_the_state():
    given = experiment()
    strategy = RecedingHorizon(decision_interval_lt=0.25, horizon_lt=1.0)
    seen = dataclasses.replace(given, sensor=WHOLE)
    one = flows_of(strategy, seen, [WholeSeen()])
    other = flows_of(strategy, given, [EQUATIONS])
    np.testing.assert_array_equal(one.actuated, other.actuated)
    assert other.actuated.any()
