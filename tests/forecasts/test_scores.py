"""Outcomes and scores of probabilities against scikit-learn and single forecasts."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.calibration import calibration_curve
from sklearn.metrics import brier_score_loss

from burstcast.base.resampling import bootstrap_weights
from burstcast.forecasts.lead_times import SeriesRatio
from burstcast.forecasts.scores import (
    base_rate,
    bin_of,
    binned,
    brier_score,
    brier_skill,
    calibration_error,
    consistency_bars,
    decomposition,
    outcomes_by_series,
    probability_scores,
    resampled_scores,
)
from burstcast.forecasts.windows import WindowSummaries, crosses, share_of_votes
from helpers_library import SERIES, count_by_series, informative_sample, samples


@given(samples(), st.integers(0, 2**31))
def test_counts_are_those_of_the_points(sample, seed):
    probability, happened, series = sample
    scored = np.random.default_rng(seed).random(len(series)) < 0.7
    result = outcomes_by_series(probability, happened, scored, series, SERIES)
    assert result.points.shape == result.events.shape == (SERIES, len(result.levels))
    np.testing.assert_array_equal(result.levels, np.unique(probability[scored]))
    for row in range(SERIES):
        for column, level in enumerate(result.levels):
            here = scored & (series == row) & (probability == level)
            assert result.points[row, column] == here.sum()
            assert result.events[row, column] == (here & happened).sum()


@given(samples())
def test_other_values_for_the_levels_are_those_of_the_points(sample):
    probability, happened, series = sample
    result = count_by_series(probability, happened, series)
    other = result.at(np.round(result.levels, 1))
    expected = count_by_series(np.round(probability, 1), happened, series)
    for name in ("levels", "points", "events"):
        np.testing.assert_array_equal(getattr(other, name), getattr(expected, name))


def test_no_point_that_counts_and_what_cannot_be_counted():
    nothing = np.zeros(3, dtype=bool)
    result = outcomes_by_series(np.full(3, np.nan), nothing, nothing, np.arange(3), 3)
    assert result.points.shape == (3, 0)
    assert result.at(result.levels).total().points.shape == (0,)
    with pytest.raises(ValueError, match="not finite"):
        count_by_series(np.array([np.nan]), np.array([True]), np.array([0]))


def test_votes_are_counted_one_by_one():
    generator = np.random.default_rng(0)
    members = [WindowSummaries(*generator.random((2, 20, 4))) for _ in range(7)]
    members[2].largest[5] = np.nan
    share = share_of_votes(members, 1, 2, 0.6)
    for point in range(20):
        votes = [crosses(member, 1, 2, 0.6)[point] for member in members]
        assert share[point] == sum(votes) / 7
    assert set(share_of_votes(members[:1], 1, 2, 0.6)) == {0.0, 1.0}
    with pytest.raises(ValueError, match="members"):
        share_of_votes([], 1, 2, 0.6)


# -- Brier score, decomposition and calibration error ----------------------------------------------

BINS = st.integers(2, 20)


@given(samples())
def test_score_and_skill_are_those_of_scikit_learn(sample):
    probability, happened, series = sample
    whole = count_by_series(probability, happened, series).total()
    expected = brier_score_loss(happened, probability, labels=[False, True])
    np.testing.assert_allclose(brier_score(whole), expected, rtol=1e-12, atol=1e-15)
    assert base_rate(whole) == pytest.approx(happened.mean())
    # beside that of the base rate, which is the variance of what happened
    skill = 1 - expected / happened.var() if happened.var() else np.nan
    np.testing.assert_allclose(brier_skill(whole), skill, rtol=1e-9, atol=1e-12)


@given(samples(), BINS)
def test_the_parts_add_up_to_the_score(sample, bins):
    whole = count_by_series(*sample).total()
    parts = decomposition(whole, bins)
    combined = parts["reliability"] - parts["resolution"] + parts["uncertainty"]
    np.testing.assert_allclose(combined, brier_score(whole), rtol=0, atol=1e-13)
    assert parts["reliability"] >= 0


@given(samples(values=st.integers(0, 10).map(lambda votes: votes / 10)))
def test_with_one_value_in_each_bin_the_parts_are_those_of_murphy(sample):
    probability, happened, _ = sample
    parts = decomposition(count_by_series(*sample).total(), 11)
    rate, reliability, resolution = happened.mean(), 0.0, 0.0
    for value in np.unique(probability):
        here = probability == value
        reliability += here.mean() * (value - happened[here].mean()) ** 2
        resolution += here.mean() * (happened[here].mean() - rate) ** 2
    np.testing.assert_allclose(parts["reliability"], reliability, atol=1e-14)
    np.testing.assert_allclose(parts["resolution"], resolution, atol=1e-14)
    np.testing.assert_allclose(parts["uncertainty"], rate * (1 - rate), atol=1e-14)


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


@given(samples(), BINS)
def test_the_calibration_error_is_the_mean_gap(sample, bins):
    probability, happened, _ = sample
    chosen = bin_of(probability, bins)
    gaps = [
        abs(probability[chosen == index].mean() - happened[chosen == index].mean())
        * (chosen == index).mean()
        for index in np.unique(chosen)
    ]
    result = calibration_error(count_by_series(*sample).total(), bins)
    np.testing.assert_allclose(result, sum(gaps), atol=1e-14)


def test_each_resample_is_scored_as_if_its_series_were_the_data():
    probability, happened, series = informative_sample()
    probability, number = np.round(probability, 2), int(series.max()) + 1
    scored = np.ones(len(series), dtype=bool)
    outcomes = outcomes_by_series(probability, happened, scored, series, number)
    weights = bootstrap_weights(number, 3, np.random.default_rng(5))
    result = resampled_scores(outcomes, weights, 0.4, 10)
    whole = probability_scores(outcomes.total(), 0.4, 10)
    for name, score in result.items():
        np.testing.assert_array_equal(score.value, whole[name])
    for row, drawn in enumerate(weights):
        points = np.concatenate(
            [np.flatnonzero(series == index) for index in np.repeat(np.arange(number), drawn)]
        )
        again = outcomes_by_series(
            probability[points], happened[points], scored[points], series[points], number
        )
        expected = probability_scores(again.total(), 0.4, 10)
        for name, score in result.items():
            np.testing.assert_allclose(score.samples[row], expected[name], err_msg=name)


# -- intervals and the bars of the reliability diagram ---------------------------------------------


def test_a_ratio_of_sums_is_resampled_series_by_series():
    generator = np.random.default_rng(5)
    top, bottom = generator.random(30), generator.random(30) + 1
    weights = bootstrap_weights(30, 400, generator)
    result = SeriesRatio("share", None, top, bottom).with_interval(weights, 0.9)
    assert result["value"] == pytest.approx(top.sum() / bottom.sum())
    ratios = [
        sum(w * t for w, t in zip(row, top, strict=True))
        / sum(w * b for w, b in zip(row, bottom, strict=True))
        for row in weights
    ]
    assert [result["low"], result["high"]] == pytest.approx(
        np.quantile(ratios, [0.05, 0.95]).tolist()
    )


def test_the_bars_have_the_width_of_a_binomial_distribution():
    # one probability, series of the same size: the count of events is binomial
    probability, series = np.full(4000, 0.3), np.repeat(np.arange(40), 100)
    outcomes = count_by_series(probability, np.zeros(4000, dtype=bool), series, 40)
    generator = np.random.default_rng(1)
    weights = bootstrap_weights(40, 2000, generator)
    low, high = consistency_bars(outcomes, 5, weights, 0.9, generator)
    deviation = np.sqrt(0.3 * 0.7 / 4000)
    assert low[1] == pytest.approx(0.3 - 1.645 * deviation, abs=0.1 * deviation)
    assert high[1] == pytest.approx(0.3 + 1.645 * deviation, abs=0.1 * deviation)
    assert np.isnan(low[[0, 2, 3, 4]]).all()
