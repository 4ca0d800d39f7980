"""Counts by level: every point counted once, in its series and at its level."""

import numpy as np
import pytest
from helpers_probability import SERIES, count_by_series, informative_sample, samples
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.forecast.windows import WindowSummaries, crosses
from burstcast.probability.outcomes import outcomes_by_series
from burstcast.probability.votes import share_of_votes


@settings(deadline=None)
@given(samples(), st.integers(0, 2**31))
def test_counts_are_those_of_the_points(sample, seed):
    probability, happened, series = sample
    scored = np.random.default_rng(seed).random(len(series)) < 0.7
    found = outcomes_by_series(probability, happened, scored, series, SERIES)
    assert found.points.shape == found.events.shape == (SERIES, len(found.levels))
    np.testing.assert_array_equal(found.levels, np.unique(probability[scored]))
    for row in range(SERIES):
        for column, level in enumerate(found.levels):
            here = scored & (series == row) & (probability == level)
            assert found.points[row, column] == here.sum()
            assert found.events[row, column] == (here & happened).sum()


def test_a_resample_is_what_repeating_series_gives():
    probability, happened, series = informative_sample()
    found = count_by_series(probability, happened, series, 40)
    chosen = np.random.default_rng(3).integers(0, 40, 40)
    rows = np.concatenate([np.flatnonzero(series == row) for row in chosen])
    repeated = count_by_series(probability[rows], happened[rows], np.zeros(len(rows), int), 1)
    resampled = found.resampled(np.bincount(chosen, minlength=40)[np.newaxis])
    there = resampled.points[0] > 0
    np.testing.assert_array_equal(resampled.levels[there], repeated.levels)
    np.testing.assert_array_equal(resampled.points[0][there], repeated.points[0])
    np.testing.assert_array_equal(resampled.events[0][there], repeated.events[0])
    once = found.resampled(np.ones((1, 40), dtype=np.int64))
    np.testing.assert_array_equal(once.events[0], found.total().events)


@settings(deadline=None)
@given(samples())
def test_other_values_for_the_levels_are_those_of_the_points(sample):
    probability, happened, series = sample
    found = count_by_series(probability, happened, series)
    other = found.at(np.round(found.levels, 1))
    expected = count_by_series(np.round(probability, 1), happened, series)
    for name in ("levels", "points", "events"):
        np.testing.assert_array_equal(getattr(other, name), getattr(expected, name))


def test_no_point_that_counts():
    nothing = np.zeros(3, dtype=bool)
    found = outcomes_by_series(np.full(3, np.nan), nothing, nothing, np.arange(3), 3)
    assert found.points.shape == (3, 0)
    assert found.at(found.levels).total().points.shape == (0,)


def test_what_cannot_be_counted():
    with pytest.raises(ValueError, match="not finite"):
        count_by_series(np.array([np.nan]), np.array([True]), np.array([0]))
    found = count_by_series(np.array([0.1, 0.2]), np.array([True, False]), np.array([0, 1]))
    with pytest.raises(ValueError, match="fall"):
        found.at(np.array([0.5, 0.4]))


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
