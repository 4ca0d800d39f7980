"""Bootstrap samples and percentiles, against scipy's; intervals of losses, by simulation."""

import numpy as np
import pytest
import scipy.stats

from burstcast.base.resampled_score import ResampledScore, median_scores
from burstcast.base.resampling import bootstrap_weights, loss_interval, percentile_interval


def test_bootstrap_weights_are_draws_with_replacement():
    weights = bootstrap_weights(7, 4000, np.random.default_rng(1))
    assert weights.shape == (4000, 7)
    assert (weights.sum(axis=1) == 7).all()
    assert weights.mean() == 1
    # how often one is drawn is binomial
    expected = scipy.stats.binom(7, 1 / 7).pmf(np.arange(4))
    analysis = np.bincount(weights[:, 3], minlength=4)[:4] / 4000
    np.testing.assert_allclose(analysis, expected, atol=0.02)


def test_interval_of_a_mean_is_that_of_scipy():
    values = np.random.default_rng(2).exponential(size=80)
    weights = bootstrap_weights(80, 20_000, np.random.default_rng(3))
    analysis = percentile_interval(weights @ values / 80, 0.9)
    theirs = scipy.stats.bootstrap(
        (values,), np.mean, n_resamples=20_000, confidence_level=0.9, method="percentile", rng=4
    ).confidence_interval
    assert analysis == pytest.approx((theirs.low, theirs.high), abs=0.01)


def test_undefined_samples_are_left_out():
    samples = np.array([np.nan, 1.0, 2.0, np.inf, 3.0])
    assert percentile_interval(samples, 0.5) == (1.5, 2.5)
    assert np.isnan(percentile_interval(np.full(3, np.nan), 0.5)).all()


def test_scores_of_the_same_resamples_are_compared_one_by_one():
    score = ResampledScore(np.array(3.0), np.array([1.0, 5.0, 2.0]))
    other = ResampledScore(np.array(1.0), np.array([0.5, 7.0, np.nan]))
    difference = score - other
    assert difference.value == 2.0
    np.testing.assert_array_equal(difference.samples, [0.5, -2.0, np.nan])
    third = ResampledScore(np.array(9.0), np.array([4.0, 6.0, 2.0]))
    middle = median_scores([{"score": each} for each in (score, other, third)])["score"]
    assert middle.value == 3.0
    np.testing.assert_array_equal(middle.samples, [1.0, 6.0, np.nan])


@pytest.mark.parametrize("share", [0.01, 0.03, 0.3])
def test_interval_of_a_loss_that_few_units_carry_holds(share):
    """Mean of errors in 60 units: rare ones of random size, or many; the truth is known."""
    generator = np.random.default_rng(5)
    held, bootstrapped, units = 0, 0, 60
    for _ in range(600):
        errors = generator.poisson(3 * share, units) * generator.exponential(size=units)
        left_out = (errors.sum() - errors) / (units - 1)
        low, high = loss_interval(errors.mean(), left_out, (errors.sum() + 1) / units, 0.95)
        held += low <= 3 * share <= high
        weights = bootstrap_weights(units, 200, generator)
        low, high = percentile_interval(weights @ errors / units, 0.95)
        bootstrapped += low <= 3 * share <= high
    assert held / 600 >= 0.92
    if share == 0.01:
        assert bootstrapped / 600 < 0.85


def test_interval_of_a_loss_of_equal_errors_is_that_of_a_poisson_count():
    """Seven of a thousand units have an error each: ends of Garwood's exact interval."""
    errors = np.zeros(1000)
    errors[:7] = 1.0
    low, high = loss_interval(7.0, (7 - errors) * 1000 / 999, 8.0, 0.95)
    assert low == pytest.approx(scipy.stats.chi2.ppf(0.025, 14) / 2, rel=0.02)
    assert high == pytest.approx(scipy.stats.chi2.ppf(0.975, 16) / 2, rel=0.02)


def test_a_loss_without_two_units_has_no_interval():
    assert np.isnan(loss_interval(0.1, np.array([0.1]), 0.2, 0.95)).all()
    assert np.isnan(loss_interval(0.1, np.array([0.1, np.nan]), 0.2, 0.95)).all()
