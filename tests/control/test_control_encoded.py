"""Control of flows of which a part is observed, or what sensors see and encoders encode."""

import dataclasses

import numpy as np
import pytest
from helpers_control import EQUATIONS, FLOW, SCHEDULE, experiment, run

from burstcast.control.strategies.probability_triggered import ProbabilityTriggered
from burstcast.control.strategies.reactive import Reactive
from burstcast.control.strategies.receding_horizon import RecedingHorizon
from burstcast.data.encoders.base import Encoder, EncodingCase
from burstcast.data.encoders.channels import EncodedFlow, StateChannels
from burstcast.data.encoders.identity import IdentityEncoder
from burstcast.data.encoders.pod import PodEncoder
from burstcast.data.encoders.state_estimate import StateEstimateEncoder
from burstcast.data.observation.part import ObservedPart
from burstcast.data.observation.velocity_sensors import VelocitySensors
from burstcast.systems.measured import MeasuredSeries
from burstcast.systems.state_space import component_names
from helpers_library import MadeUpForecaster
from kolmogorov_flow import KolmogorovFlow

PART = ObservedPart.of(FLOW, ["a1", "mean = (a1 + a9) / 2"], "observable")
WHOLE = ObservedPart.of(FLOW, [f"a{number}" for number in range(1, 10)], "observable")


def encoded(encoder, names):
    """The flow with an encoder of all components."""
    channels = StateChannels(EncodingCase(FLOW), None, encoder)
    return EncodedFlow(channels, FLOW, MeasuredSeries([*names], "observable"))


class WholeSeen(MadeUpForecaster):
    """The equations, given all components and the observable after them."""

    def start(self, washout):
        return EQUATIONS.start(np.ascontiguousarray(washout[:, :9]))

    def advance(self, memory, steps):
        outputs, memory = EQUATIONS.advance(memory, steps)
        observable = FLOW.observable(outputs.transpose(1, 0, 2))
        return np.concatenate([outputs, observable[:, np.newaxis]], axis=1), memory


@pytest.mark.parametrize(
    "sensor", [encoded(IdentityEncoder(), component_names(FLOW)), WHOLE], ids=["channels", "part"]
)
def test_what_shows_the_whole_state_controls_as_the_state_does(sensor):
    given = experiment()
    strategy = RecedingHorizon(decision_interval_lt=0.25, horizon_lt=1.0)
    seen = dataclasses.replace(given, sensor=sensor)
    whole, plain = run(strategy, seen, WholeSeen()), run(strategy, given, EQUATIONS)
    np.testing.assert_array_equal(whole.actuated, plain.actuated)
    np.testing.assert_array_equal(whole.controlled, plain.controlled)
    assert plain.actuated.any()


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
    run(strategy, given, classifier, noise=noise)
    states, steps = given.washouts, SCHEDULE.washout
    seen = states + noise[:, :steps, :9]
    observable = FLOW.observable(np.moveaxis(states, -1, 0)) + noise[:, :steps, 9]
    expected = np.stack([seen[..., 0] ** 2, seen[..., 1] - seen[..., 2], observable], axis=-1)
    (first, *_) = classifier.given
    rows = [np.abs(expected - washout).max(axis=(1, 2)).argmin() for washout in first]
    np.testing.assert_allclose(first, expected[rows], atol=1e-12)


def test_a_probability_as_high_as_the_limit_in_the_chosen_windows_is_an_alarm():
    given = dataclasses.replace(
        experiment(), sensor=encoded(IdentityEncoder(), component_names(FLOW))
    )
    strategy = ProbabilityTriggered(decision_interval_lt=0.25, probability=0.5, hold_lt=0.75)
    just = dataclasses.replace(strategy, probability=0.6)
    flows, as_high = (run(each, given, Recorded(0.06)) for each in (strategy, just))
    assert 0 < flows.actuated.mean() < 1
    np.testing.assert_array_equal(as_high.actuated, flows.actuated)
    both = dataclasses.replace(strategy, windows=2.0)
    assert run(both, given, Recorded(0.06)).looks.alarm.all()


# -- a part of the state ---------------------------------------------------------------------------


def test_a_part_has_its_quantities_and_the_observable():
    states = np.random.default_rng(1).normal(size=(9, 3, 2))
    seen = PART(states)
    np.testing.assert_array_equal(seen[0], states[0])
    np.testing.assert_allclose(seen[1], (states[0] + states[8]) / 2)
    np.testing.assert_array_equal(seen[2], FLOW.observable(states))
    np.testing.assert_array_equal(PART.space.observable(seen), seen[2])
    with pytest.raises(ValueError, match="no column 'a12'"):
        ObservedPart.of(FLOW, ["a12"], "observable")


def test_a_rule_acts_on_what_is_observed_alone():
    given = experiment()
    seen = dataclasses.replace(given, sensor=PART)
    by_part = Reactive(decision_interval_lt=0.2, level=0.1, watch="a1 - mean")
    by_all = Reactive(decision_interval_lt=0.2, level=0.1, watch="(a1 - a9) / 2")
    of_part, of_all = run(by_part, seen, None), run(by_all, given, None)
    np.testing.assert_array_equal(of_part.actuated, of_all.actuated)
    np.testing.assert_array_equal(of_part.controlled, of_all.controlled)
    assert 0 < of_part.actuated.mean() < 1
    with pytest.raises(ValueError, match="unknown name 'a9'"):
        by_all.policy(seen, None)


# -- encoders are fitted once ----------------------------------------------------------------------


@pytest.mark.parametrize(
    "kind", ["identity", "shift_invariants:Invariants", "pod", "state_estimate"]
)
@pytest.mark.parametrize("sensors", [False, True])
def test_channels_are_restored_to_the_bit_from_what_fitting_has_found(kind, sensors):
    flow = KolmogorovFlow(largest_wavenumber=4)
    generator = np.random.default_rng(2)
    states = generator.normal(size=(2, 90, flow.dimension))
    observation = VelocitySensors(flow, (6, 6), (0.3, 0.2)) if sensors else None
    if kind == "state_estimate" and not sensors:
        pytest.skip("there is nothing to estimate where states are observed themselves")
    options = {"modes": 5} if kind == "pod" else {}
    case = EncodingCase(flow, options, observation)
    fitted, _ = StateChannels.of_training(kind, states, case, 0.05, 7, "turbulence")
    arrays = {name: array.copy(order="C") for name, array in fitted.arrays.items()}
    restored = StateChannels.restore(kind, case, arrays)
    seen = case.readings(generator.normal(size=(flow.dimension, 11, 3)))
    assert fitted.encode(seen).tobytes() == restored.encode(seen).tobytes()
    assert type(restored.encoder) is type(fitted.encoder)
    nothing_fitted = not isinstance(fitted.encoder, PodEncoder | StateEstimateEncoder)
    assert (not arrays) == (nothing_fitted and fitted.estimate is None)
