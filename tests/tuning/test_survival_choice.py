"""The choice among points that the objective cannot tell apart."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast.tuning.survival import as_good_as_the_best, nearest_escape_rate
from burstcast.tuning.uncertainty import objective_uncertainty


@given(st.integers(0, 1000), st.integers(1, 12), st.integers(2, 9))
def test_the_best_is_as_good_as_itself_and_far_points_are_not(seed, points, intervals):
    generator = np.random.default_rng(seed)
    log_errors = generator.normal(-5, 1, (points, intervals))
    log_errors[-1] = log_errors[0] + 10.0 + 0.01 * generator.random(intervals)
    found = objective_uncertainty(log_errors)
    good = as_good_as_the_best(found.excess, found.paired_standard_error)
    best = int(log_errors.mean(axis=1).argmin())
    assert good[best]
    if points > 1:
        assert not good[-1]
    for row in range(points):
        if row != best:
            # one standard error of the mean of the paired differences
            difference = log_errors[row] - log_errors[best]
            error = difference.std(ddof=1) / np.sqrt(intervals)
            assert good[row] == (difference.mean() <= error)


def test_with_a_single_interval_only_the_best_is_left():
    found = objective_uncertainty(np.array([[-5.0], [-5.1], [-5.1]]))
    good = as_good_as_the_best(found.excess, found.paired_standard_error)
    assert good.tolist() == [False, True, False]


def test_the_nearest_rate_is_taken_the_first_of_equals():
    assert nearest_escape_rate(np.array([3.0, 1.0, 1.9]), 2.0) == 2
    assert nearest_escape_rate(np.array([3.0, 1.0]), 2.0) == 0
    assert nearest_escape_rate(np.array([np.nan, 9.0]), 2.0) == 1
    # without any rate, or anything to compare with, it is the best objective, which comes first
    assert nearest_escape_rate(np.array([np.nan, np.nan]), 2.0) == 0
    assert nearest_escape_rate(np.array([3.0, 1.0]), np.nan) == 0
    with pytest.raises(ValueError, match="no point"):
        nearest_escape_rate(np.empty(0), 1.0)
