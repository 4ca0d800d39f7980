"""Control of flows that sensors see and encoders encode, by trajectories and by probabilities."""

import dataclasses

import numpy as np
import pytest
from test_control_observed_part import WholeSeen
from test_control_strategies import EQUATIONS, FLOW, SCHEDULE, experiment

from burstcast.control.controllers.registry import controlling_monitor
from burstcast.control.strategies.probability_triggered import ProbabilityTriggered
from burstcast.control.strategies.receding_horizon import RecedingHorizon
from burstcast.encoders.base import Encoder, EncodingCase
from burstcast.encoders.channels import EncodedFlow, StateChannels
from burstcast.encoders.identity import IdentityEncoder
from burstcast.systems.measured import MeasuredSeries
from burstcast.systems.state_space import component_names


def encoded(encoder, names):
    """The flow with an encoder of all components."""
    channels = StateChannels(EncodingCase(FLOW), None, encoder)
    return EncodedFlow(channels, FLOW, MeasuredSeries([*names], "observable"))


def simulated(strategy, given, forecaster, noise=None):
    monitor = controlling_monitor("forecaster", strategy, given, [forecaster])
    return strategy.simulate(given, monitor, noise=noise)


def test_channels_that_are_the_state_control_as_the_state_does():
    given = experiment()
    strategy = RecedingHorizon(decision_interval_lt=0.25, horizon_lt=1.0)
    seen = dataclasses.replace(given, sensor=encoded(IdentityEncoder(), component_names(FLOW)))
    one, other = simulated(strategy, seen, WholeSeen()), simulated(strategy, given, EQUATIONS)
    np.testing.assert_array_equal(one.actuated, other.actuated)
    np.testing.assert_array_equal(one.controlled, other.controlled)
    assert other.actuated.any()


class Recorded:
    """A classifier by the last channel alone, which keeps all that it was given."""

    def __init__(self, level):
        self.level, self.given = level, []

    def probabilities(self, washouts):
        self.given.append(washouts)
        high = washouts[:, -1, -1] >= self.level
        return np.stack([np.where(high, 0.6, 0.1), np.where(high, 0.1, 0.9)], axis=1)


class Squares(Encoder):
    """A nonlinear encoder: a1 squared, and the difference of a2 and a3."""

    @classmethod
    def fit(cls, training, case):
        return cls()

    @classmethod
    def channel_names(cls, case):
        return ("one", "two")

    def encode(self, observed):
        return np.stack([observed[0] ** 2, observed[1] - observed[2]])


def test_noise_is_added_before_the_encoder():
    given = dataclasses.replace(experiment(2), sensor=encoded(Squares(), ["one", "two"]))
    strategy = ProbabilityTriggered(decision_interval_lt=1.0, probability=0.5, hold_lt=1.0)
    length = strategy.timing(SCHEDULE).length
    noise = np.random.default_rng(3).normal(size=(2, length, 10))
    classifier = Recorded(np.inf)
    simulated(strategy, given, classifier, noise)
    states, steps = given.washouts, SCHEDULE.washout
    seen = states + noise[:, :steps, :9]
    observable = FLOW.observable(np.moveaxis(states, -1, 0)) + noise[:, :steps, 9]
    expected = np.stack([seen[..., 0] ** 2, seen[..., 1] - seen[..., 2], observable], axis=-1)
    (first, *_) = classifier.given
    rows = [np.abs(expected - one).max(axis=(1, 2)).argmin() for one in first]
    np.testing.assert_allclose(first, expected[rows], atol=1e-12)


def test_an_alarm_holds_whatever_later_decisions_say():
    given = dataclasses.replace(
        experiment(), sensor=encoded(IdentityEncoder(), component_names(FLOW))
    )
    strategy = ProbabilityTriggered(decision_interval_lt=0.25, probability=0.5, hold_lt=0.75)
    found = simulated(strategy, given, Recorded(0.06))
    timing = found.timing
    expected = np.zeros_like(found.actuated)
    for look in range(found.decisions.on.shape[1]):
        now = timing.first_forecast + look * timing.interval
        expected[found.decisions.on[:, look], now + 1 : now + 1 + timing.steps(0.75)] = True
    np.testing.assert_array_equal(found.actuated, expected)
    assert 0 < found.actuated.mean() < 1
    both = dataclasses.replace(strategy, windows=2.0)
    assert simulated(both, given, Recorded(0.06)).decisions.on.all()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"probability": 1.0}, "probability must lie between 0 and 1, not be 1"),
        ({"hold_lt": 0.1}, "hold_lt must be at least decision_interval_lt, 0.25, not 0.1"),
        ({"windows": 1.5}, "windows must be a whole number from 1 on, not 1.5"),
    ],
)
def test_settings_that_do_not_fit_are_refused(changes, message):
    strategy = ProbabilityTriggered(decision_interval_lt=0.25, probability=0.5, hold_lt=1.0)
    with pytest.raises(ValueError, match=message):
        dataclasses.replace(strategy, **changes).check(SCHEDULE)
