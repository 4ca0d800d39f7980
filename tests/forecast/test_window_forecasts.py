"""Forecasts reduced to windows, against one member and one starting point at a time."""

from dataclasses import replace

import numpy as np
import pytest

from burstcast.forecast import window_forecasts as module
from burstcast.forecast.window_forecasts import member_forecasts, window_forecasts
from burstcast.forecast.windows import summarise
from burstcast.forecasters.analogues import Analogues
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.equations_filtered import FilteredEquations
from burstcast.forecasters.linear_inverse import LinearInverseModel
from burstcast.systems.integration import integrate
from burstcast.systems.lorenz63 import Lorenz63
from burstcast.systems.parameters import SystemParameters
from helpers_forecasters import MadeUpForecaster

OPTIONS = {"noise": 0.02, "members": 6, "inflation": 1.0, "neighbours": 4}
CASE = ForecastingCase(Lorenz63(), 0.01, 2, 50, OPTIONS)
BOUNDARIES = (3, 8, 20)
MEMBERS = {FilteredEquations: 6, Analogues: 4, LinearInverseModel: 1}


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
    starts = [(row, start) for row in range(3) for start in (20, 70, 120, 200)]
    found = np.stack([training[row, start : start + 10] for row, start in starts])
    return found + 0.05 * np.random.default_rng(1).standard_normal(found.shape)


@pytest.mark.parametrize(("kind", "number"), MEMBERS.items())
def test_forecasts_are_those_of_each_memory_alone(kind, number, training, washouts):
    forecaster = kind.fit(training, CASE)
    found = window_forecasts(forecaster, first_component, washouts, BOUNDARIES)
    assert len(found.members) == number
    assert found.member_first.shape == (12, number if number > 1 else 0, 2)
    for point, washout in enumerate(washouts):
        given = np.ascontiguousarray(washout[:, :, np.newaxis])
        ensemble = forecaster.ensemble(given)
        members = [np.ascontiguousarray(ensemble[..., member, :]) for member in range(number)]
        for summaries, memory in zip(
            [found, *found.members], [forecaster.start(given), *members], strict=True
        ):
            outputs, _ = forecaster.advance(memory, BOUNDARIES[-1])
            expected = summarise(outputs[:, 0], BOUNDARIES)
            np.testing.assert_array_equal(summaries.first[point], expected.first[0])
            np.testing.assert_array_equal(summaries.largest[point], expected.largest[0])


@pytest.mark.parametrize("kind", MEMBERS)
@pytest.mark.parametrize("sizes", [(1, 1), (5, 30), (12, 7)])
def test_batches_change_nothing(kind, sizes, training, washouts, monkeypatch):
    forecaster = kind.fit(training, CASE)
    whole = window_forecasts(forecaster, first_component, washouts, BOUNDARIES)
    for name, size in zip(("POINTS_PER_BATCH", "TRAJECTORIES_PER_BATCH"), sizes, strict=True):
        monkeypatch.setattr(module, name, size)
    parts = window_forecasts(forecaster, first_component, washouts, BOUNDARIES)
    for name, values in vars(whole).items():
        np.testing.assert_array_equal(getattr(parts, name), values)


class Counting(MadeUpForecaster):
    """Goes on from the last observed value in steps of one; lost where that value is negative."""

    def __init__(self):
        self.batches = []

    def start(self, washout, parameters=None):
        self.batches.append(washout.shape[2])
        return washout[-1].copy()

    def advance(self, memory, steps, parameters=None):
        ahead = np.arange(1, steps + 1, dtype=np.float64)[:, np.newaxis, np.newaxis]
        outputs = np.where(memory < 0, np.nan, memory + ahead)
        return outputs, outputs[-1]


def test_forecasts_begin_one_step_after_the_last_observation(monkeypatch):
    washouts = np.zeros((7, 4, 2))
    washouts[:, -1, 0] = np.arange(7) * 100
    washouts[2, -1, 0] = -1
    forecaster = Counting()
    monkeypatch.setattr(module, "POINTS_PER_BATCH", 3)
    found = window_forecasts(forecaster, first_component, washouts, (2, 5, 9))
    assert forecaster.batches == [3, 3, 1]
    expected = 100 * np.arange(7)[:, np.newaxis] + np.array([2, 5])
    expected = expected.astype(float)
    expected[2] = np.nan
    np.testing.assert_array_equal(found.first, expected)
    np.testing.assert_array_equal(found.largest, expected + np.array([3, 4]))
    assert found.diverged.tolist() == [False, False, True, False, False, False, False]


def test_members_scatter_around_the_forecast_of_their_mean(training, washouts):
    forecaster = FilteredEquations.fit(training, CASE)
    washout = np.ascontiguousarray(washouts.transpose(1, 2, 0))
    states = member_forecasts(forecaster, washout, 3)
    assert states.shape == (3, 3, OPTIONS["members"], len(washouts))
    of_mean, _ = forecaster.advance(forecaster.start(washout), 3)
    # nearly linear over so short a time
    np.testing.assert_allclose(states.mean(axis=2), of_mean, rtol=0.01, atol=0.02)
    assert (states.std(axis=2) > 1e-3).all()


def test_forecasts_under_a_schedule_are_those_of_each_point_by_itself(monkeypatch):
    """Cut into batches, members side by side: each point keeps its own schedule."""
    parameters = SystemParameters.of(Lorenz63(), ["rho"])
    case = replace(CASE, parameters=parameters)
    generator = np.random.default_rng(6)
    washouts = generator.normal(size=(7, 12, 3)) + np.array([1.0, 1.0, 25.0])
    schedule = generator.choice([24.0, 28.0], size=(7, 11 + BOUNDARIES[-1], 1))
    model = FilteredEquations.fit(generator.normal(size=(2, 60, 3)), case)
    monkeypatch.setattr(module, "POINTS_PER_BATCH", 3)
    monkeypatch.setattr(module, "TRAJECTORIES_PER_BATCH", 5)
    found = window_forecasts(model, case.system.observable, washouts, BOUNDARIES, schedule)
    for point in range(7):
        past, ahead = schedule[point, :11, :, np.newaxis], schedule[point, 11:, :, np.newaxis]
        memory = model.start(washouts[point][..., np.newaxis], past)
        outputs, _ = model.advance(memory, BOUNDARIES[-1], ahead)
        expected = summarise(case.system.observable(outputs.transpose(1, 0, 2)), BOUNDARIES)
        assert np.array_equal(found.largest[point], expected.largest[0])
