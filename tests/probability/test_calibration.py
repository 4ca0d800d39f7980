"""Calibrations against scikit-learn's, and what a prior does."""

import json

import numpy as np
import pytest
from helpers_probability import count_by_series, samples
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.calibration import _SigmoidCalibration
from sklearn.isotonic import IsotonicRegression, isotonic_regression

from burstcast.probability.alarm_rule import AlarmRule
from burstcast.probability.brier import brier_score, calibration_error
from burstcast.probability.calibration import (
    UNCALIBRATED,
    isotonic,
    logistic,
    pool_adjacent_violators,
)
from burstcast.probability.scores import resampled_scores


@settings(deadline=None)
@given(
    st.lists(st.tuples(st.floats(-5, 5), st.floats(0.1, 10)), min_size=1, max_size=40),
)
def test_pooling_is_that_of_scikit_learn(pairs):
    values, weights = np.array(pairs).T
    expected = isotonic_regression(values, sample_weight=weights)
    np.testing.assert_allclose(pool_adjacent_violators(values, weights), expected, atol=1e-10)


@settings(deadline=None)
@given(samples(), st.lists(st.floats(-1, 2), min_size=1, max_size=20))
def test_the_calibration_is_that_of_scikit_learn(sample, asked):
    probability, happened, _ = sample
    found = isotonic(count_by_series(*sample).total())
    oracle = IsotonicRegression(out_of_bounds="clip").fit(probability, happened)
    np.testing.assert_allclose(found(np.array(asked)), oracle.predict(asked), atol=1e-10)


@settings(deadline=None)
@given(samples(), st.floats(0, 50))
def test_a_prior_counts_as_forecasts_that_came_true(sample, prior):
    whole = count_by_series(*sample).total()
    found = isotonic(whole, prior)
    values = np.concatenate([whole.levels] * 3)
    outcome = np.repeat([1.0, 0.0, 1.0], len(whole.levels))
    outcome[2 * len(whole.levels) :] = whole.levels
    weights = np.concatenate(
        [whole.events, whole.points - whole.events, np.full(len(whole.levels), prior)]
    )
    oracle = IsotonicRegression(out_of_bounds="clip").fit(values, outcome, sample_weight=weights)
    np.testing.assert_allclose(found(whole.levels), oracle.predict(whole.levels), atol=1e-10)


@settings(deadline=None)
@given(samples())
def test_calibration_never_lowers_and_is_reliable_where_it_was_fitted(sample):
    whole = count_by_series(*sample).total()
    found = isotonic(whole)
    assert (np.diff(found.values) > 0).all()
    assert (np.diff(found.probabilities) >= 0).all()
    calibrated = whole.at(found(whole.levels))
    assert brier_score(calibrated) <= brier_score(whole) + 1e-12
    # levels of their own are hit exactly on average
    assert calibration_error(calibrated, 1000) < 1e-9


def test_a_strong_prior_believes_the_votes():
    sample = np.array([0.0, 0.5, 1.0]), np.array([True, False, False]), np.zeros(3, dtype=int)
    whole = count_by_series(*sample).total()
    np.testing.assert_allclose(isotonic(whole, 1e12)(whole.levels), whole.levels, atol=1e-10)
    np.testing.assert_array_equal(UNCALIBRATED(whole.levels), whole.levels)


def test_what_cannot_be_calibrated():
    whole = count_by_series(np.array([0.5]), np.array([True]), np.array([0])).total()
    with pytest.raises(ValueError, match="0 forecasts or more"):
        isotonic(whole, -1)


def test_without_any_forecast_no_probability_is_known():
    none = count_by_series(np.zeros(0), np.zeros(0, dtype=bool), np.zeros(0, dtype=int)).total()
    rule = AlarmRule.chosen(none, isotonic(none, 30))
    assert np.isnan(rule.calibration(np.array([0.0, 0.5]))).all()
    restored = AlarmRule.restore(json.loads(json.dumps(rule.record())))
    assert np.isnan(restored.calibration(np.array([1.0]))).all()
    # forecasts of the test series then do not count: all scores are undefined
    test = count_by_series(np.array([0.5, 0.7]), np.array([True, False]), np.array([0, 1]))
    scored = test.at(restored.calibration(test.levels))
    assert scored.points.shape[1] == 0
    weights = np.ones((3, len(scored.points)), dtype=np.int64)
    for name, score in resampled_scores(scored, weights, restored.threshold, 11).items():
        assert np.isnan(score.value), name


# -- of probabilities that are all different -------------------------------------------------------


def drawn(slope, points=2000, seed=1):
    """Probabilities whose log-odds are those of the truth, times a slope, plus a half."""
    generator = np.random.default_rng(seed)
    odds = generator.normal(-2.0, 1.5, size=points)
    happened = generator.random(points) < 1 / (1 + np.exp(-odds))
    given = 1 / (1 + np.exp(-(slope * odds + 0.5)))
    return given, happened, np.zeros(points, dtype=int)


@pytest.mark.parametrize("slope", [0.5, 1.0, 3.0])
def test_logistic_calibration_is_that_of_platt(slope):
    given, happened, _ = sample = drawn(slope)
    found = logistic(count_by_series(*sample).total())
    odds = np.log(given) - np.log1p(-given)
    oracle = _SigmoidCalibration().fit(odds, happened.astype(float))
    # between its knots the calibration is linear
    np.testing.assert_allclose(found(given), oracle.predict(odds), atol=5e-4)
    assert (np.diff(found(np.sort(given))) > 0).all()


def test_logistic_calibration_where_nothing_is_told_or_everything():
    given, happened, rows = drawn(1.0, 300)
    reversed_ = count_by_series(1 - given, happened, rows).total()
    np.testing.assert_allclose(logistic(reversed_)(given), happened.mean(), atol=0.01)
    apart = count_by_series(np.where(happened, 0.9, 0.1), happened, rows).total()
    count = int(happened.sum())
    ends = [1 / (302 - count), (count + 1) / (count + 2)]
    np.testing.assert_allclose(logistic(apart)(np.array([0.1, 0.9])), ends, rtol=2e-3)
    none = count_by_series(*(values[:0] for values in (given, happened, rows))).total()
    assert np.isnan(logistic(none)(given)).all()
