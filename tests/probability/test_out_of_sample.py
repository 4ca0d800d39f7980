"""Each training series is forecast without what it has taught."""

from dataclasses import dataclass

import numpy as np
import pytest

from burstcast.forecast.windows import forecast_summaries
from burstcast.forecasters.base import ForecastingCase
from burstcast.forecasters.linear_inverse import LinearInverseModel
from burstcast.probability.out_of_sample import leave_one_out_summaries
from burstcast.systems.lorenz63 import Lorenz63
from helpers_forecasters import MadeUpForecaster

CASE = ForecastingCase(Lorenz63(), 0.01, 5, 20, {})
BOUNDARIES = (2, 5, 9)


@dataclass
class MeanForecaster(MadeUpForecaster):
    """Forecasts the mean of what it has learnt from, and remembers the washout of training."""

    mean: float

    @classmethod
    def fit(cls, training, case):
        return cls(float(training.mean()))

    def start(self, washout):
        return washout[-1]

    def advance(self, memory, steps):
        return np.full((steps, *memory.shape), self.mean), memory


def first_component(states):
    return states[0]


def test_each_point_is_forecast_by_those_who_have_not_seen_its_series():
    training = np.arange(4.0)[:, np.newaxis, np.newaxis] * np.ones((4, 30, 3))
    series = np.array([2, 0, 3, 2])  # none in series 1
    summaries, diverged = leave_one_out_summaries(
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
    np.testing.assert_allclose(summaries.first, expected)
    np.testing.assert_allclose(summaries.largest, expected)
    assert not diverged.any()


def test_a_fitted_kind_is_fitted_anew():
    generator = np.random.default_rng(0)
    training = generator.standard_normal((3, 40, 3)).cumsum(axis=1)
    washouts = generator.standard_normal((6, 4, 3))
    series = np.array([0, 0, 1, 1, 2, 2])
    arguments = CASE, 4, first_component, washouts, series, BOUNDARIES
    whole = LinearInverseModel.fit(training, CASE)
    found, _ = leave_one_out_summaries(whole, training, *arguments)
    for row in range(3):
        anew = LinearInverseModel.fit(np.delete(training, row, axis=0), CASE)
        here = series == row
        expected, _ = forecast_summaries(anew, first_component, washouts[here], BOUNDARIES)
        np.testing.assert_array_equal(found.largest[here], expected.largest)
    # whatever the series was
    other = training.copy()
    other[1] = generator.standard_normal((40, 3))
    again, _ = leave_one_out_summaries(whole, other, *arguments)
    np.testing.assert_array_equal(again.first[2:4], found.first[2:4])
    assert (again.first[[0, 1, 4, 5]] != found.first[[0, 1, 4, 5]]).all()


def test_a_single_series_leaves_nothing():
    training = np.zeros((1, 30, 3))
    with pytest.raises(ValueError, match="two training series"):
        list(MeanForecaster(0.0).leave_one_out(training, CASE, 5))
