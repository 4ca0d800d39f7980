"""Analogues against a search by brute force, and persistence."""

import numpy as np
import pytest

from burstcast.forecasters.analogues import Analogues
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.persistence import Persistence
from burstcast.systems.lorenz63 import Lorenz63

CASE = ForecastingCase(Lorenz63(), 0.01, 2, 50, {"neighbours": 4})


@pytest.fixture
def training():
    return np.random.default_rng(1).standard_normal((3, 30, 2)).cumsum(axis=1) * [1.0, 20.0]


@pytest.fixture
def washout():
    return np.random.default_rng(2).standard_normal((5, 2, 7)) * [[3.0], [60.0]]


def continuations(training, state, neighbours, steps):
    """What followed the nearest states, brute force; NaN after the end of a series."""
    distance = np.square((training[:, :-1] - state) / training.std(axis=(0, 1))).sum(axis=2)
    nearest = np.argsort(distance, axis=None)[:neighbours]
    padded = np.concatenate([training, np.full((len(training), steps, 2), np.nan)], axis=1)
    places = [np.unravel_index(index, distance.shape) for index in nearest]
    return np.array([padded[row, step + 1 : step + 1 + steps] for row, step in places])


def test_the_forecast_is_the_mean_of_what_followed(training, washout):
    model = Analogues.fit(training, CASE)
    outputs, _ = model.advance(model.start(washout), 12)
    for point in range(7):
        followed = continuations(training, washout[-1, :, point], 4, 12)
        alive = np.isfinite(followed[..., 0]).any(axis=0)
        expected = np.nanmean(followed[:, alive], axis=0)
        np.testing.assert_allclose(outputs[alive, :, point], expected)
        assert np.isnan(outputs[~alive, :, point]).all()


def test_members_follow_one_analogue_each(training, washout):
    model = Analogues.fit(training, CASE)
    members = model.ensemble(washout)
    assert members.shape == (1, 4, 7)
    outputs, _ = model.advance(members.reshape(1, -1), 12)
    outputs = outputs.reshape(12, 2, 4, 7)
    for point in range(7):
        followed = continuations(training, washout[-1, :, point], 4, 12)
        np.testing.assert_array_equal(outputs[..., point].transpose(2, 0, 1), followed)


def test_where_all_analogues_have_ended_there_is_no_forecast(training, washout):
    model = Analogues.fit(training, CASE)
    outputs, memory = model.advance(model.start(washout), 30)
    assert np.isnan(outputs[-1]).all()
    assert np.isnan(memory).all()
    assert model.diverged(outputs).all()
    later, _ = model.advance(memory, 1)
    assert np.isnan(later).all()


def test_persistence_stays(washout):
    model = Persistence.fit(np.zeros((1, 1, 2)), CASE)
    outputs, memory = model.advance(model.start(washout), 3)
    for state in outputs:
        np.testing.assert_array_equal(state, washout[-1])
    np.testing.assert_array_equal(memory, washout[-1])


def test_a_component_that_is_constant_in_training_tells_no_analogues_apart(training, washout):
    with_gauge = np.concatenate([training, np.full((3, 30, 1), 7.0)], axis=2)
    seen = np.concatenate([washout, np.full((5, 1, 7), 7.0)], axis=1)
    found = Analogues.fit(with_gauge, CASE).start(seen)
    np.testing.assert_array_equal(found, Analogues.fit(training, CASE).start(washout))
