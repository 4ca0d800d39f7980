"""Bootstrap samples and intervals against scipy's."""

import numpy as np
import pytest
import scipy.stats

from burstcast.statistics.resampling import bootstrap_weights, percentile_interval


def test_weights_are_draws_with_replacement():
    weights = bootstrap_weights(7, 4000, np.random.default_rng(1))
    assert weights.shape == (4000, 7)
    assert (weights.sum(axis=1) == 7).all()
    assert weights.mean() == 1
    # how often one is drawn is binomial
    expected = scipy.stats.binom(7, 1 / 7).pmf(np.arange(4))
    found = np.bincount(weights[:, 3], minlength=4)[:4] / 4000
    np.testing.assert_allclose(found, expected, atol=0.02)


def test_interval_of_a_mean_is_that_of_scipy():
    values = np.random.default_rng(2).exponential(size=80)
    weights = bootstrap_weights(80, 20_000, np.random.default_rng(3))
    found = percentile_interval(weights @ values / 80, 0.9)
    theirs = scipy.stats.bootstrap(
        (values,), np.mean, n_resamples=20_000, confidence_level=0.9, method="percentile", rng=4
    ).confidence_interval
    assert found == pytest.approx((theirs.low, theirs.high), abs=0.01)


def test_undefined_samples_are_left_out():
    samples = np.array([np.nan, 1.0, 2.0, np.inf, 3.0])
    assert percentile_interval(samples, 0.5) == (1.5, 2.5)
    assert np.isnan(percentile_interval(np.full(3, np.nan), 0.5)).all()
