"""Precursors, where the true probabilities are known, and the ranking of starting points."""

import numpy as np
import pytest
from sklearn.metrics import average_precision_score, roc_auc_score

from burstcast.forecasters.precursor import fitted_classifiers, precursor_features
from burstcast.forecasts.scores import ANY, ONSET, Window, ranking_scores
from burstcast.forecasts.windows import WindowForecasts, WindowSummaries


def test_features_are_the_present_and_the_lags():
    washouts = np.arange(24.0).reshape(2, 4, 3)
    result = precursor_features(washouts, (1, 3))
    assert np.array_equal(result[1], [21, 22, 23, 18, 19, 20, 12, 13, 14])
    with pytest.raises(ValueError, match="a lag of 4 steps takes a longer washout than 4"):
        precursor_features(washouts, (4,))


def test_nothing_to_tell_apart_is_refused():
    generator = np.random.default_rng(5)
    features, happened = generator.normal(size=(100, 3)), generator.random((100, 2)) < 0.5
    happened[:, 1] = False
    with pytest.raises(ValueError, match=r"none of the 100 .* in prediction window 1"):
        fitted_classifiers("boosting", features, happened)
    with pytest.raises(ValueError, match="each of the 100"):
        fitted_classifiers("boosting", features, ~happened)


def test_an_unknown_classifier_is_refused():
    with pytest.raises(ValueError, match="did you mean 'boosting'"):
        fitted_classifiers("bosting", np.zeros((2, 3)), np.array([[True], [False]]))


# -- ranking ---------------------------------------------------------------------------------------


def test_areas_are_those_of_scikit_learn():
    generator = np.random.default_rng(0)
    for _ in range(20):
        strength = generator.integers(0, 9, 50).astype(float)
        happened = generator.random(50) < 0.3
        weights = generator.integers(0, 3, (4, 50))
        result = ranking_scores(strength, happened, weights)
        for row, weight in enumerate(weights):
            average = average_precision_score(happened, strength, sample_weight=weight)
            area = roc_auc_score(happened, strength, sample_weight=weight)
            np.testing.assert_allclose(result["average_precision"][row], average)
            np.testing.assert_allclose(result["roc_area"][row], area)


def test_without_events_nothing_is_ranked():
    strength, weights = np.arange(4.0), np.array([[1, 1, 0, 0], [1, 1, 1, 1]])
    result = ranking_scores(strength, np.array([False, False, True, False]), weights)
    assert np.isnan(result["roc_area"][0])
    assert np.isnan(result["average_precision"][0])
    assert result["roc_area"][1] == 2 / 3


def forecasts(first, largest, members=0):
    """Forecasts of three points in two windows."""
    first, largest = np.array(first, dtype=float), np.array(largest, dtype=float)
    of_members = np.empty((2, len(first), members, first.shape[1]))
    return WindowForecasts(first, largest, np.zeros(len(first), dtype=bool), *of_members)


def test_onsets_are_no_events_under_way_and_members_are_averaged():
    truth = WindowSummaries(np.array([[0.0], [3.0], [0.0]]), np.array([[4.0], [5.0], [1.0]]))
    window = Window(0, 1, 2.5)
    assert window.happened(truth, ONSET).tolist() == [True, False, False]
    assert window.happened(truth, ANY).tolist() == [True, True, False]
    forecast = forecasts([[0, 0], [3, 0], [1, 0]], [[1, 4], [5, 5], [2, 1]])
    window = Window(0, 2, 2.5)
    # the second is above the threshold when the window begins: the mean of 4 and 2
    assert window.strength(forecast, ONSET).tolist() == [4, 3, 2]
    assert window.strength(forecast, ANY).tolist() == [4, 5, 2]
    assert Window(1, 1, 2.5).strength(forecast, ONSET).tolist() == [4, 5, 1]
    forecast = forecasts([[0], [0]], [[9], [9]], members=2)
    forecast.member_first[:] = 0
    forecast.member_largest[:] = np.array([[1, 3], [np.inf, 5]])[:, :, np.newaxis]
    assert Window(0, 1, 2).strength(forecast, ONSET).tolist() == [2, 3]
