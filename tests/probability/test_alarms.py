"""Alarms at a threshold, the choice of it, and curves over all thresholds, against scikit-learn."""

import numpy as np
import pytest
from helpers_probability import count_by_series, samples
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.metrics import (
    average_precision_score,
    confusion_matrix,
    f1_score,
    precision_recall_curve,
    roc_auc_score,
    roc_curve,
)

from burstcast.probability.alarms import (
    average_precision,
    best_threshold,
    counts_at,
    counts_at_all_levels,
    false_alarm_rate,
    roc_area,
)
from burstcast.probability.calibration import isotonic


@settings(deadline=None)
@given(samples(), st.floats(0, 1))
def test_alarms_are_those_of_the_points(sample, threshold):
    probability, happened, _ = sample
    counts = counts_at(count_by_series(*sample).total(), threshold)
    matrix = confusion_matrix(happened, probability >= threshold, labels=[False, True])
    assert [counts.true_negative, counts.false_positive] == matrix[0].tolist()
    assert [counts.false_negative, counts.true_positive] == matrix[1].tolist()


@settings(deadline=None)
@given(samples())
def test_areas_are_those_of_scikit_learn(sample):
    probability, happened, _ = sample
    whole = count_by_series(*sample).total()
    if happened.any():
        expected = average_precision_score(happened, probability)
        np.testing.assert_allclose(average_precision(whole), expected, rtol=1e-12)
    else:
        assert np.isnan(average_precision(whole))
    if happened.any() and not happened.all():
        expected = roc_auc_score(happened, probability)
        np.testing.assert_allclose(roc_area(whole), expected, rtol=1e-12)
    else:
        assert np.isnan(roc_area(whole))


def test_curves_are_those_of_scikit_learn():
    generator = np.random.default_rng(4)
    probability = np.round(generator.random(300), 1)
    happened = generator.random(300) < probability
    counts = counts_at_all_levels(
        count_by_series(probability, happened, np.zeros(300, int)).total()
    )
    rate, hits, _ = roc_curve(happened, probability, drop_intermediate=False)
    np.testing.assert_allclose(false_alarm_rate(counts), rate[1:], rtol=1e-13)
    np.testing.assert_allclose(counts.recall, hits[1:], rtol=1e-13)
    precision, recall, _ = precision_recall_curve(happened, probability)
    np.testing.assert_allclose(counts.precision, precision[:-1][::-1], rtol=1e-13)
    np.testing.assert_allclose(counts.recall, recall[:-1][::-1], rtol=1e-13)


@settings(deadline=None)
@given(samples(values=st.integers(0, 10).map(lambda votes: votes / 10)))
def test_after_plain_isotonic_regression_no_threshold_is_better(sample):
    probability, happened, _ = sample
    whole = count_by_series(*sample).total()
    calibrated = whole.at(isotonic(whole)(whole.levels))
    threshold = best_threshold(calibrated.levels, calibrated.points)
    if not happened.any():
        assert threshold == 1
        return
    reached = counts_at(calibrated, threshold).f_score
    # of the probabilities, and of the values that they come from
    best = max(f1_score(happened, probability >= value) for value in np.unique(probability))
    np.testing.assert_allclose(reached, best, rtol=1e-12)


@settings(deadline=None)
@given(samples())
def test_the_best_threshold_maximises_what_probabilities_let_expect(sample):
    probability = sample[0]
    whole = count_by_series(*sample).total()
    threshold = best_threshold(whole.levels, whole.points)
    assert 0 <= threshold <= 1
    if not probability.any():
        assert threshold == 1
        return

    def expected(limit):
        alarm = probability >= limit
        return 2 * probability[alarm].sum() / (alarm.sum() + probability.sum())

    best = max(expected(value) for value in np.unique(probability))
    np.testing.assert_allclose(expected(threshold), best, rtol=1e-12)


def test_the_threshold_lies_between_the_levels():
    levels, points = np.array([0.0, 0.2, 0.8, 1.0]), np.array([100, 10, 5, 5])
    assert best_threshold(levels, points) == pytest.approx(0.5)
    # all alike: alarms always
    assert best_threshold(np.array([0.1]), np.array([50])) == 0
    assert best_threshold(np.array([0.0]), np.array([50])) == 1
