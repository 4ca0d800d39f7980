"""Scores with their resamples, by hand."""

import numpy as np

from burstcast.statistics.resampled_score import ResampledScore, median_score


def test_scores_of_the_same_resamples_are_compared_one_by_one():
    one = ResampledScore(np.array(3.0), np.array([1.0, 5.0, 2.0]))
    other = ResampledScore(np.array(1.0), np.array([0.5, 7.0, np.nan]))
    difference = one - other
    assert difference.value == 2.0
    np.testing.assert_array_equal(difference.samples, [0.5, -2.0, np.nan])
    middle = median_score([one, other, ResampledScore(np.array(9.0), np.array([4.0, 6.0, 2.0]))])
    assert middle.value == 3.0
    np.testing.assert_array_equal(middle.samples, [1.0, 6.0, np.nan])
