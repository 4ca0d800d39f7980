"""Histograms and the distances between densities, against numpy, scipy and hand-computed cases."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import trapezoid
from scipy.stats import binom, wasserstein_distance

from burstcast.statistics.densities import (
    Histogram,
    bin_edges,
    density_interval,
    histogram,
    kantorovich_metric,
    mean_density,
    mean_logarithmic_error,
)

EDGES = np.linspace(0.0, 1.0, 5)
bin_counts = st.lists(st.integers(0, 30), min_size=4, max_size=4).filter(any)
samples = st.lists(st.floats(-2, 3, allow_subnormal=False), min_size=1, max_size=40)


def filled(counts, below=0, above=0):
    return Histogram(EDGES, np.array(counts, dtype=np.int64), below, above)


@given(samples)
def test_counts_are_numpys(values):
    # the edges themselves are where implementations differ
    values = np.concatenate([values, EDGES, [np.nextafter(1.0, 2.0), np.nextafter(0.0, -1.0)]])
    found = histogram(values, EDGES)
    np.testing.assert_array_equal(found.counts, np.histogram(values, EDGES)[0])
    assert found.below == (values < 0).sum()
    assert found.above == (values > 1).sum()
    assert found.below + found.inside + found.above == len(values)


def test_density_is_normalised_over_the_values_inside():
    found = Histogram(np.array([0.0, 1.0, 3.0]), np.array([1, 3]), below=7, above=2)
    np.testing.assert_allclose(found.density, [0.25, 0.375])
    np.testing.assert_allclose(found.cumulative, [0, 0.25, 1])


@given(bin_counts)
def test_cumulative_is_the_integral_of_the_density(counts):
    found = filled(counts, below=3)
    np.testing.assert_allclose(
        found.cumulative[1:], np.cumsum(found.density * np.diff(EDGES)), atol=1e-14
    )
    assert found.cumulative[0] == 0
    assert found.cumulative[-1] == 1


def test_density_of_nothing_is_undefined():
    empty = filled([0, 0, 0, 0], above=3)
    assert np.isnan(empty.density).all()
    assert np.isnan(kantorovich_metric(empty, filled([1, 0, 0, 0])))
    assert np.isnan(mean_logarithmic_error(filled([1, 0, 0, 0]), empty))


def test_what_is_no_histogram_is_refused():
    with pytest.raises(ValueError, match="not finite"):
        histogram(np.array([0.2, np.nan]), EDGES)
    with pytest.raises(ValueError, match="increase"):
        histogram(np.array([0.2]), np.array([0.0, 1.0, 1.0]))
    with pytest.raises(ValueError, match="bound"):
        Histogram(EDGES, np.array([1, 2]))
    with pytest.raises(ValueError, match="negative"):
        filled([1, -1, 0, 0])
    other = Histogram(EDGES + 1e-9, np.ones(4, dtype=np.int64))
    for function in (kantorovich_metric, mean_logarithmic_error):
        with pytest.raises(ValueError, match="common bins"):
            function(filled([1, 1, 1, 1]), other)


def test_kantorovich_metric_of_shifted_bins_is_the_shift():
    # uniform over the first bin against uniform over the third: everything moves by two bins
    assert kantorovich_metric(filled([5, 0, 0, 0]), filled([0, 0, 3, 0])) == pytest.approx(0.5)


def test_kantorovich_metric_where_the_distributions_cross_within_a_bin():
    # CDF differences at the edges: 0, 1/4, -1/4, 0, 0. A triangle of base 1/4 in the first bin and
    # in the third, two of base 1/8 in the second, all of height 1/4
    first, second = filled([2, 0, 2, 0]), filled([1, 2, 1, 0])
    assert kantorovich_metric(first, second) == pytest.approx(3 * 0.5 * 0.25 * 0.25)


@given(bin_counts, bin_counts)
def test_kantorovich_metric_is_the_integral_of_the_difference(first, second):
    first, second = filled(first), filled(second)
    grid = np.linspace(0, 1, 40001)
    difference = np.interp(grid, EDGES, first.cumulative) - np.interp(
        grid, EDGES, second.cumulative
    )
    expected = trapezoid(np.abs(difference), grid)
    assert kantorovich_metric(first, second) == pytest.approx(expected, abs=1e-8)
    assert kantorovich_metric(first, first) == 0


@settings(max_examples=30)
@given(bin_counts, bin_counts)
def test_kantorovich_metric_is_scipys_for_evenly_filled_bins(first, second):
    def evenly(counts, per_value=200):
        within = (np.arange(per_value) + 0.5) / per_value / 4
        return np.concatenate(
            [np.tile(edge + within, n) for edge, n in zip(EDGES, counts, strict=False)]
        )

    expected = wasserstein_distance(evenly(first), evenly(second))
    assert kantorovich_metric(filled(first), filled(second)) == pytest.approx(expected, abs=2e-3)


def test_bins_of_the_paper_resolve_the_kantorovich_metric():
    # values as skewed as the kinetic energy; within a bin, binning may move a value by its width
    generator = np.random.default_rng(1)
    edges = np.linspace(0.015, 0.47, 201)
    first = 0.016 + 0.05 * generator.beta(0.8, 6, 40_000) / 0.12
    second = 0.016 + 0.05 * generator.beta(0.9, 6, 40_000) / 0.12
    assert first.max() < 0.47
    assert second.max() < 0.47
    exact = wasserstein_distance(first, second)
    binned = kantorovich_metric(histogram(first, edges), histogram(second, edges))
    assert binned == pytest.approx(exact, rel=0.01)


def test_mean_logarithmic_error_by_hand():
    first, second = filled([10, 80, 10, 0]), filled([1, 8, 1, 0])
    # the densities are equal; the bin that is empty in both counts one
    assert mean_logarithmic_error(first, second) == pytest.approx(0.25)
    # empty in one only: two bins of four
    first, second = filled([50, 0, 50, 0]), filled([50, 50, 0, 0])
    assert mean_logarithmic_error(first, second) == pytest.approx((0 + 1 + 1 + 1) / 4)
    # an error beyond one is not cut off
    first, second = filled([1, 0, 0, 999]), filled([500, 0, 0, 500])
    expected = (math.log10(500) + 1 + 1 + math.log10(999 / 500)) / 4
    assert mean_logarithmic_error(first, second) == pytest.approx(expected)


@given(bin_counts, bin_counts, st.integers(1, 5))
def test_mean_logarithmic_error_is_symmetric_and_knows_no_sample_size(first, second, factor):
    one = mean_logarithmic_error(filled(first), filled(second))
    assert one == pytest.approx(mean_logarithmic_error(filled(second), filled(first)))
    assert one == pytest.approx(
        mean_logarithmic_error(filled(first), filled([factor * count for count in second]))
    )


def test_values_outside_the_range_change_no_distance():
    first, second = [1, 2, 3, 4], [4, 3, 2, 1]
    outside = filled(first, below=100, above=50)
    assert kantorovich_metric(outside, filled(second)) == kantorovich_metric(
        filled(first), filled(second)
    )
    assert mean_logarithmic_error(outside, filled(second)) == mean_logarithmic_error(
        filled(first), filled(second)
    )


def test_mean_density_weighs_each_histogram_alike():
    first, second, empty = filled([1, 0, 0, 0]), filled([0, 0, 30, 10]), filled([0, 0, 0, 0])
    expected = 0.5 * (first.density + second.density)
    assert mean_density([first, second]) == pytest.approx(expected)
    # nothing is known from a histogram without values
    assert mean_density([empty, first, second]) == pytest.approx(expected)
    assert np.isnan(mean_density([empty])).all()


def interval(counts, rows, resamples=4000, confidence=0.95):
    how = {"resamples": resamples, "confidence": confidence}
    generator = np.random.default_rng(0)
    counts = [np.asarray(own, np.int64).reshape(-1, 4) for own in counts]
    rows = [np.asarray(own, np.int64) for own in rows]
    return density_interval(EDGES, counts, rows, generator=generator, **how)


def test_interval_of_a_density_is_that_of_shares_of_flows():
    """Flows that lie in one bin each: the share of one kind is binomial."""
    flows = np.repeat([[10, 0, 0, 0], [0, 0, 0, 10]], [30, 70], axis=0)
    low, high = interval([flows], [np.arange(100)])
    share = binom.ppf([0.025, 0.975], 100, 0.3) / 100 / np.diff(EDGES)[0]
    assert [low[0], high[0]] == pytest.approx(share, rel=0.02)
    assert low[1] == high[1] == 0


def test_densities_that_share_flows_are_resampled_together():
    """What one density has more of, the other has less of: their mean does not scatter."""
    one = np.repeat([[10, 0, 0, 0], [0, 0, 0, 10]], 20, axis=0)
    rows = np.arange(40)
    low, high = interval([one, one[::-1]], [rows, rows])
    assert low[0] == pytest.approx(high[0])
    low, high = interval([one, one[::-1]], [rows, rows + 40])
    assert high[0] > 1.3 * low[0]


def test_interval_of_no_values_is_none():
    assert np.isnan(interval([[]], [[]])).all()
    assert np.isnan(interval([np.zeros((3, 4))], [[0, 1, 2]])).all()
    with_an_empty_one = interval([np.zeros((2, 4)), np.ones((2, 4))], [[0, 1], [0, 1]])
    assert with_an_empty_one == pytest.approx(interval([np.ones((2, 4))], [[0, 1]]))


def test_mean_density_needs_histograms_on_common_bins():
    with pytest.raises(ValueError, match="no density"):
        mean_density([])
    other = Histogram(np.array([0.0, 1.0]), np.array([1]))
    with pytest.raises(ValueError, match="common bins"):
        mean_density([filled([1, 0, 0, 0]), other])


def test_bins_are_equal_and_their_edges_include_both_ends() -> None:
    np.testing.assert_allclose(bin_edges(0.0, 0.5, 5), [0, 0.1, 0.2, 0.3, 0.4, 0.5])
