"""Bootstrap samples, percentiles and analysis of variance, against scipy's."""

import itertools

import numpy as np
import pytest
import scipy.stats
from hypothesis import given
from hypothesis import strategies as st

from burstcast.base.resampled_score import ResampledScore, median_score
from burstcast.base.resampling import bootstrap_weights, percentile_interval
from burstcast.statistics.analysis_of_variance import analysis_of_variance, mean_and_margin


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
    middle = median_score([score, other, ResampledScore(np.array(9.0), np.array([4.0, 6.0, 2.0]))])
    assert middle.value == 3.0
    np.testing.assert_array_equal(middle.samples, [1.0, 6.0, np.nan])


# -- analysis of variance --------------------------------------------------------------------------


def squares_by_least_squares(values, axis):
    """What the indicators of one factor explain, of all that they and the mean explain."""
    cells = np.array(list(itertools.product(*map(range, values.shape))))
    levels = (cells[:, [axis]] == np.arange(values.shape[axis])).astype(float)
    flat = values.ravel()
    left = flat - levels @ np.linalg.lstsq(levels, flat, rcond=None)[0]
    return np.square(flat - flat.mean()).sum() - np.square(left).sum()


@given(
    st.integers(0, 1000),
    st.lists(st.integers(1, 4), min_size=1, max_size=3),
    st.sampled_from([0, 1]),
)
def test_analysis_of_variance_is_that_of_nested_least_squares(seed, shape, scatter):
    generator = np.random.default_rng(seed)
    values = scatter * generator.normal(size=shape)
    for axis, count in enumerate(shape):  # without scatter nothing is left but main effects
        effects = generator.normal(size=count)
        values = np.moveaxis(np.moveaxis(values, axis, -1) + effects, -1, axis)
    analysis = analysis_of_variance(values)
    assert analysis.mean == pytest.approx(values.mean())
    squares = [squares_by_least_squares(values, axis) for axis in range(len(shape))]
    left = values.size - 1 - sum(count - 1 for count in shape)
    noise = max(0.0, values.var() * values.size - sum(squares)) / left if left else np.nan
    expected = [(left, noise, noise)]
    for count, square in zip(shape, squares, strict=True):
        mean_square = square / (count - 1) if count > 1 else np.nan
        # the mean square of a level's effect holds the scatter of its cells
        component = (mean_square - (noise if left else 0.0)) * count / values.size
        expected.append((count - 1, mean_square, np.maximum(0.0, component)))
    numbers = [
        (score.degrees, score.mean_square, score.standard_deviation**2)
        for score in (analysis.residual, *analysis.factors)
    ]
    np.testing.assert_allclose(numbers, expected, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("values", [np.empty((0, 2)), np.array([[1.0, np.nan]])])
def test_a_design_with_holes_is_refused(values):
    with pytest.raises(ValueError, match="every cell"):
        analysis_of_variance(values)


def test_an_interval_of_a_mean_is_that_of_students_test():
    values = [0.1, 0.4, 0.2, 0.7]
    expected = scipy.stats.ttest_1samp(values, 0.0).confidence_interval(0.95)
    mean, margin = mean_and_margin(values, 0.95)
    assert (mean - margin, mean + margin) == pytest.approx((expected.low, expected.high))
    assert np.isnan(mean_and_margin([0.5], 0.95)[1])
