"""Each training series is forecast without what it has taught."""

from dataclasses import dataclass

import numpy as np
import pytest

from burstcast.forecast.window_forecasts import window_forecasts
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.linear_inverse import LinearInverseModel
from burstcast.probability.out_of_sample import out_of_sample_forecasts
from burstcast.systems.lorenz63 import Lorenz63
from helpers_forecasters import MadeUpForecaster

CASE = ForecastingCase(Lorenz63(), 0.01, 5, 20, {})
BOUNDARIES = (2, 5, 9)


@dataclass
class MeanForecaster(MadeUpForecaster):
    """Forecasts the mean of the training series; three members add their number to it."""

    mean: float

    @classmethod
    def fit(cls, training, case, parameters=None):
        return cls(float(training.mean()))

    def start(self, washout, parameters=None):
        return np.zeros((1, washout.shape[2]))

    def ensemble(self, washout, parameters=None):
        return np.arange(3.0)[np.newaxis, :, np.newaxis] * np.ones((1, 3, washout.shape[2]))

    def advance(self, memory, steps, parameters=None):
        return np.repeat((self.mean + memory)[np.newaxis], steps, axis=0), memory


def first_component(states):
    return states[0]


def test_each_point_is_forecast_by_those_who_have_not_seen_its_series():
    training = np.arange(4.0)[:, np.newaxis, np.newaxis] * np.ones((4, 30, 3))
    series = np.array([2, 0, 3, 2])  # none in series 1, and not in order
    found = out_of_sample_forecasts(
        MeanForecaster.fit(training, CASE),
        training,
        CASE,
        5,
        first_component,
        np.zeros((4, 5, 3)),
        series,
        BOUNDARIES,
    )
    without = {row: np.delete(np.arange(4.0), row).mean() for row in range(4)}
    expected = np.array([without[row] for row in series])[:, np.newaxis] * np.ones((4, 2))
    for number, forecasts in ((0, found), *enumerate(found.members)):
        np.testing.assert_allclose(forecasts.first, expected + number)
        np.testing.assert_allclose(forecasts.largest, expected + number)
    assert len(found.members) == 3
    assert found.diverged.tolist() == [False] * 4


def test_a_fitted_kind_is_fitted_anew():
    generator = np.random.default_rng(0)
    training = generator.standard_normal((3, 40, 3)).cumsum(axis=1)
    washouts = generator.standard_normal((6, 4, 3))
    series = np.array([0, 0, 1, 1, 2, 2])
    arguments = CASE, 4, first_component, washouts, series, BOUNDARIES
    whole = LinearInverseModel.fit(training, CASE)
    found = out_of_sample_forecasts(whole, training, *arguments)
    for row in range(3):
        anew = LinearInverseModel.fit(np.delete(training, row, axis=0), CASE)
        here = series == row
        expected = window_forecasts(anew, first_component, washouts[here], BOUNDARIES)
        np.testing.assert_array_equal(found.largest[here], expected.largest)
    # whatever the series was
    other = training.copy()
    other[1] = generator.standard_normal((40, 3))
    again = out_of_sample_forecasts(whole, other, *arguments)
    np.testing.assert_array_equal(again.first[2:4], found.first[2:4])
    assert (again.first[[0, 1, 4, 5]] != found.first[[0, 1, 4, 5]]).all()


def test_a_single_series_leaves_nothing():
    training = np.zeros((1, 30, 3))
    with pytest.raises(ValueError, match="two training series"):
        list(MeanForecaster(0.0).leave_one_out(training, CASE, 5))
