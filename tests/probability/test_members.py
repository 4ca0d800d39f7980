"""Forecasts by all members of an ensemble, against one member and one point at a time."""

from dataclasses import dataclass

import numpy as np
import pytest

from burstcast.forecast.windows import summarise
from burstcast.forecasters.analogues import Analogues
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.equations_filtered import FilteredEquations
from burstcast.forecasters.linear_inverse import LinearInverseModel
from burstcast.probability import members
from burstcast.probability.committee_event import member_observables
from burstcast.probability.members import (
    has_members,
    leave_one_out_member_summaries,
    member_forecasts,
    member_summaries,
)
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from helpers_forecasters import MadeUpForecaster

OPTIONS = {"noise": 0.02, "members": 6, "inflation": 1.0, "neighbours": 4}
CASE = ForecastingCase(Lorenz63(), 0.01, 2, 50, OPTIONS)
BOUNDARIES = (3, 8, 20)
KINDS = (FilteredEquations, Analogues)


def first_component(states):
    return states[0]


@pytest.fixture(scope="module")
def training():
    """Three series of 300 steps."""
    start = np.random.default_rng(3).normal(size=(3, 3)) + np.array([[1.0], [1.0], [25.0]])
    states = integrate(CASE.system, start, 0.01, 2 * 400, stride=2)[101:]
    return np.ascontiguousarray(states.transpose(2, 0, 1))


@pytest.fixture(scope="module")
def washouts(training):
    """Twelve stretches of ten steps, with noise."""
    found = np.concatenate(
        [
            training[row, start : start + 10][np.newaxis]
            for row in range(3)
            for start in (20, 70, 120, 200)
        ]
    )
    return found + 0.05 * np.random.default_rng(1).standard_normal(found.shape)


@pytest.mark.parametrize("kind", KINDS)
def test_members_forecast_as_if_each_were_alone(kind, training, washouts):
    who = kind.fit(training, CASE)
    found = member_summaries(who, first_component, washouts, BOUNDARIES)
    assert len(found) == OPTIONS["members" if kind is FilteredEquations else "neighbours"]
    for point, washout in enumerate(washouts):
        memory = who.ensemble(np.ascontiguousarray(washout[:, :, np.newaxis]))
        for number, member in enumerate(found):
            alone = np.ascontiguousarray(memory[..., number, :])
            outputs, _ = who.advance(alone, BOUNDARIES[-1])
            expected = summarise(outputs[:, 0], BOUNDARIES)
            np.testing.assert_array_equal(member.first[point], expected.first[0])
            np.testing.assert_array_equal(member.largest[point], expected.largest[0])


@pytest.mark.parametrize("kind", KINDS)
def test_batches_change_nothing(kind, training, washouts, monkeypatch):
    who = kind.fit(training, CASE)
    whole = member_summaries(who, first_component, washouts, BOUNDARIES)
    for size in (1, 30):
        monkeypatch.setattr(members, "TRAJECTORIES_PER_BATCH", size)
        parts = member_summaries(who, first_component, washouts, BOUNDARIES)
        for one, other in zip(whole, parts, strict=True):
            np.testing.assert_array_equal(one.first, other.first)
            np.testing.assert_array_equal(one.largest, other.largest)


def test_members_scatter_around_the_forecast_of_their_mean(training, washouts):
    who = FilteredEquations.fit(training, CASE)
    washout = np.ascontiguousarray(washouts.transpose(1, 2, 0))
    states = member_forecasts(who, washout, 3)
    assert states.shape == (3, 3, OPTIONS["members"], len(washouts))
    of_mean, _ = who.advance(who.start(washout), 3)
    # nearly linear over so short a time
    np.testing.assert_allclose(states.mean(axis=2), of_mean, rtol=0.01, atol=0.02)
    assert (states.std(axis=2) > 1e-3).all()


@pytest.mark.parametrize("steps", [1, 4])
def test_observables_of_members_are_those_of_their_states(training, washouts, steps):
    who = FilteredEquations.fit(training, CASE)
    found = member_observables(who, first_component, washouts[3], steps)
    states = member_forecasts(who, washouts[3:4].transpose(1, 2, 0), steps)
    np.testing.assert_array_equal(found, states[:, 0, :, 0].T)


@dataclass
class Counting(MadeUpForecaster):
    """Three members forecast the mean of what was learnt, plus their number."""

    mean: float

    @classmethod
    def fit(cls, training, case):
        return cls(float(training.mean()))

    def ensemble(self, washout):
        return np.arange(3.0)[np.newaxis, :, np.newaxis] * np.ones((1, 3, washout.shape[2]))

    def start(self, washout):
        raise NotImplementedError

    def advance(self, memory, steps):
        return np.repeat((self.mean + memory)[np.newaxis], steps, axis=0), memory


def test_each_point_is_forecast_by_those_who_have_not_seen_its_series():
    training = np.arange(4.0)[:, np.newaxis, np.newaxis] * np.ones((4, 30, 1))
    series = np.array([2, 0, 3, 2])  # none in series 1, and not in order
    found = leave_one_out_member_summaries(
        Counting.fit(training, CASE),
        training,
        CASE,
        5,
        first_component,
        np.zeros((4, 5, 1)),
        series,
        BOUNDARIES,
    )
    without = {row: np.delete(np.arange(4.0), row).mean() for row in range(4)}
    for number, member in enumerate(found):
        expected = np.array([without[row] + number for row in series])
        np.testing.assert_allclose(member.first, expected[:, np.newaxis] * np.ones((4, 2)))
        np.testing.assert_allclose(member.largest, member.first)


def test_who_has_members():
    assert [has_members(kind) for kind in KINDS] == [True, True]
    assert not has_members(LinearInverseModel)
