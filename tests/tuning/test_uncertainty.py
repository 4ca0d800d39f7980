"""Standard errors of the search's objectives, and of their differences from the best."""

import math

import numpy as np
import pytest
from scipy import stats

from burstcast.tuning.uncertainty import objective_uncertainty

SHARED = np.random.default_rng(1).normal(size=40)
"""What the intervals do to all points alike."""
OWN = 0.1 * np.random.default_rng(2).normal(size=(3, 40))
LOG_ERRORS = np.array([[0.2], [0.0], [1.0]]) + SHARED + OWN


def test_standard_errors_are_those_of_scipy():
    found = objective_uncertainty(LOG_ERRORS)
    np.testing.assert_allclose(found.standard_error, stats.sem(LOG_ERRORS, axis=1), rtol=1e-12)


@pytest.mark.parametrize("point", [0, 2])
def test_differences_are_those_of_a_paired_test(point):
    found = objective_uncertainty(LOG_ERRORS)
    paired = stats.ttest_rel(LOG_ERRORS[point], LOG_ERRORS[1])
    assert found.excess[point] / found.paired_standard_error[point] == pytest.approx(
        paired.statistic, rel=1e-10
    )


def test_the_best_has_no_excess_and_what_is_shared_cancels():
    found = objective_uncertainty(LOG_ERRORS)
    assert int(np.argmin(LOG_ERRORS.mean(axis=1))) == 1
    assert (found.excess[1], found.paired_standard_error[1]) == (0, 0)
    assert np.all(found.excess >= 0)
    assert np.all(found.paired_standard_error < 0.3 * found.standard_error)


def test_one_interval_says_nothing_about_its_error():
    found = objective_uncertainty(LOG_ERRORS[:, :1])
    best = int(np.argmin(LOG_ERRORS[:, 0]))
    for point in range(3):
        assert math.isnan(found.standard_error[point])
        assert math.isnan(found.paired_standard_error[point]) == (point != best)


def test_a_search_without_points_is_refused():
    with pytest.raises(ValueError, match="no point"):
        objective_uncertainty(np.empty((0, 5)))
