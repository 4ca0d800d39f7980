"""Bootstrap samples of events, against the averages of what each sample holds."""

import numpy as np
import pytest
import scipy.stats
from hypothesis import given
from hypothesis import strategies as st

from burstcast.forecast.horizon_intervals import resampled_averages
from burstcast.statistics.resampling import bootstrap_weights, percentile_interval


@given(st.lists(st.floats(0, 10), min_size=1, max_size=12), st.integers(0, 100))
def test_averages_are_those_of_what_was_drawn(horizons, seed):
    values = np.array(horizons)
    weights = bootstrap_weights(values.size, 20, np.random.default_rng(seed))
    means, medians = resampled_averages(values, weights)
    for weight, mean, median in zip(weights, means, medians, strict=True):
        drawn = np.repeat(values, weight)
        assert mean == pytest.approx(drawn.mean(), abs=1e-12)
        assert median == pytest.approx(np.median(drawn), abs=1e-12)


def test_the_interval_of_the_mean_is_that_of_its_standard_error():
    values = np.random.default_rng(0).gamma(4.0, 1.0, size=500)
    weights = bootstrap_weights(500, 4000, np.random.default_rng(1))
    low, high = percentile_interval(resampled_averages(values, weights)[0], 0.95)
    scipys = scipy.stats.bootstrap((values,), np.mean, n_resamples=4000, rng=2).confidence_interval
    np.testing.assert_allclose([low, high], [scipys.low, scipys.high], atol=0.02)
    half = 1.96 * values.std(ddof=1) / np.sqrt(500)
    np.testing.assert_allclose([low, high], values.mean() + half * np.array([-1, 1]), atol=0.02)


def test_without_events_there_is_no_average():
    means, medians = resampled_averages(np.empty(0), np.empty((5, 0), dtype=np.int64))
    assert means.size == medians.size == 0
    assert np.isnan(percentile_interval(means, 0.95)).all()
