"""Scores of counts against scikit-learn, and their intervals over series."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst
from sklearn.metrics import confusion_matrix, f1_score, precision_score, recall_score

from burstcast.forecasts.classification import SCORES, ContingencyTable, ratio


@given(st.integers(1, 40).flatmap(lambda points: npst.arrays(bool, (2, points))))
def test_scores_are_those_of_scikit_learn(pair):
    happened, predicted = pair
    (true_negative, false_positive), (false_negative, true_positive) = confusion_matrix(
        happened, predicted, labels=[False, True]
    )
    counts = ContingencyTable(true_positive, false_positive, false_negative, true_negative)
    for score, reference in zip(SCORES, (precision_score, recall_score, f1_score), strict=True):
        expected = reference(happened, predicted, zero_division=np.nan)
        np.testing.assert_allclose(getattr(counts, score), expected, rtol=1e-14)


def test_scores_of_nothing_are_not_defined():
    nothing = ContingencyTable(*np.zeros((4, 1), dtype=np.int64))
    assert np.isnan([getattr(nothing, score) for score in SCORES]).all()


def test_ratios_of_arrays_and_numbers():
    np.testing.assert_array_equal(ratio([1, 0, 3], [2, 0, 0]), [0.5, np.nan, np.nan])
    assert ratio(1, 4) == 0.25
    assert np.isnan(ratio(1, 0))
