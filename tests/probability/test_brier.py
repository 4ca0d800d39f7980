"""Brier score, decomposition and calibration error against scikit-learn and single forecasts."""

import numpy as np
import pytest
from helpers_probability import count_by_series, informative_sample, samples
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.calibration import calibration_curve
from sklearn.metrics import brier_score_loss

from burstcast.probability.brier import (
    base_rate,
    bin_of,
    binned,
    brier_score,
    brier_skill,
    calibration_error,
    decomposition,
)

BINS = st.integers(2, 20)


@settings(deadline=None)
@given(samples())
def test_the_score_is_that_of_scikit_learn(sample):
    probability, happened, series = sample
    whole = count_by_series(probability, happened, series).total()
    expected = brier_score_loss(happened, probability, labels=[False, True])
    np.testing.assert_allclose(brier_score(whole), expected, rtol=1e-12, atol=1e-15)
    assert base_rate(whole) == pytest.approx(happened.mean())


@settings(deadline=None)
@given(samples(), BINS)
def test_the_parts_add_up_to_the_score(sample, bins):
    whole = count_by_series(*sample).total()
    parts = decomposition(whole, bins)
    combined = parts.reliability - parts.resolution + parts.uncertainty
    np.testing.assert_allclose(combined, brier_score(whole), rtol=0, atol=1e-13)
    assert parts.reliability >= 0


@settings(deadline=None)
@given(samples(values=st.integers(0, 10).map(lambda votes: votes / 10)))
def test_with_one_value_in_each_bin_the_parts_are_those_of_murphy(sample):
    probability, happened, _ = sample
    parts = decomposition(count_by_series(*sample).total(), 11)
    rate, reliability, resolution = happened.mean(), 0.0, 0.0
    for value in np.unique(probability):
        here = probability == value
        reliability += here.mean() * (value - happened[here].mean()) ** 2
        resolution += here.mean() * (happened[here].mean() - rate) ** 2
    np.testing.assert_allclose(parts.reliability, reliability, atol=1e-14)
    np.testing.assert_allclose(parts.resolution, resolution, atol=1e-14)
    np.testing.assert_allclose(parts.uncertainty, rate * (1 - rate), atol=1e-14)


def test_skill_of_known_forecasts():
    happened = np.arange(20) % 4 == 0
    series = np.zeros(20, dtype=np.int64)

    def skill(probability):
        return brier_skill(count_by_series(probability, happened, series).total())

    assert skill(happened.astype(float)) == 1
    assert skill(np.full(20, 0.25)) == pytest.approx(0, abs=1e-15)
    assert skill(np.zeros(20)) == pytest.approx(1 - 0.25 / (0.25 * 0.75))
    quiet = count_by_series(np.full(4, 0.1), np.zeros(4, dtype=bool), series[:4]).total()
    assert np.isnan(brier_skill(quiet))


@pytest.mark.parametrize("bins", [5, 8, 16])
def test_bins_are_those_of_scikit_learn(bins):
    # values inside of bins: which of two bins has their common edge is a convention
    generator = np.random.default_rng(2)
    probability = generator.random(500)
    happened = generator.random(500) < probability
    whole = binned(count_by_series(probability, happened, np.zeros(500, int)).total(), bins)
    frequency, mean = calibration_curve(happened, probability, n_bins=bins)
    there = whole.points > 0
    np.testing.assert_allclose(whole.frequency[there], frequency, rtol=1e-13)
    np.testing.assert_allclose(whole.mean_probability[there], mean, rtol=1e-13)


def test_bins_hold_their_lower_edge_and_shares_of_ten_have_one_each():
    assert bin_of(np.array([0, 0.1, 0.2, 0.999, 1.0]), 10).tolist() == [0, 1, 2, 9, 9]
    assert bin_of(np.arange(11) / 10, 11).tolist() == list(range(11))
    for bins in range(2, 40):
        assert bin_of(np.arange(bins) / bins, bins).tolist() == list(range(bins))
    with pytest.raises(ValueError, match="between 0 and 1"):
        bin_of(np.array([1.1]), 10)


@settings(deadline=None)
@given(samples(), BINS)
def test_the_calibration_error_is_the_mean_gap(sample, bins):
    probability, happened, _ = sample
    chosen = bin_of(probability, bins)
    gaps = [
        abs(probability[chosen == one].mean() - happened[chosen == one].mean())
        * (chosen == one).mean()
        for one in np.unique(chosen)
    ]
    found = calibration_error(count_by_series(*sample).total(), bins)
    np.testing.assert_allclose(found, sum(gaps), atol=1e-14)


def test_scores_of_many_resamples_are_those_of_each():
    outcomes = count_by_series(*informative_sample(), number=40)
    weights = np.random.default_rng(1).multinomial(40, np.full(40, 1 / 40), size=5)
    many = outcomes.resampled(weights)
    for row in range(5):
        one = outcomes.resampled(weights[row : row + 1])
        for score in (brier_skill, lambda some: calibration_error(some, 7)):
            np.testing.assert_array_equal(score(many)[row], score(one)[0])
        parts, part = decomposition(many, 7), decomposition(one, 7)
        np.testing.assert_array_equal(parts.resolution[row], part.resolution[0])
