"""Scores of counts against scikit-learn, and their intervals over series."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst
from sklearn.metrics import confusion_matrix, f1_score, precision_score, recall_score

from burstcast.base.resampling import bootstrap_weights, percentile_interval
from burstcast.forecasts.alarms import counts_at
from burstcast.forecasts.classification import SCORES, Counts, ratio
from burstcast.forecasts.outcomes import Outcomes


@given(st.integers(1, 40).flatmap(lambda points: npst.arrays(bool, (2, points))))
def test_scores_are_those_of_scikit_learn(pair):
    happened, predicted = pair
    (true_negative, false_positive), (false_negative, true_positive) = confusion_matrix(
        happened, predicted, labels=[False, True]
    )
    counts = Counts(true_positive, false_positive, false_negative, true_negative)
    for score, reference in zip(SCORES, (precision_score, recall_score, f1_score), strict=True):
        expected = reference(happened, predicted, zero_division=np.nan)
        np.testing.assert_allclose(getattr(counts, score), expected, rtol=1e-14)


def test_scores_of_nothing_are_not_defined():
    nothing = Counts(*np.zeros((4, 1), dtype=np.int64))
    assert np.isnan([getattr(nothing, score) for score in SCORES]).all()


def test_ratios_of_arrays_and_numbers():
    np.testing.assert_array_equal(ratio([1, 0, 3], [2, 0, 0]), [0.5, np.nan, np.nan])
    assert ratio(1, 4) == 0.25
    assert np.isnan(ratio(1, 0))


# -- intervals over series -------------------------------------------------------------------------


def outcomes_of(true_positive, false_positive, false_negative, true_negative=5):
    """Outcomes by series of forecasts that are alarms, 1, or none, 0."""
    alarms = np.add(true_positive, false_positive)
    silent = np.add(false_negative, true_negative)
    events = np.stack([np.broadcast_to(false_negative, alarms.shape), true_positive], axis=-1)
    return Outcomes(np.array([0.0, 1.0]), np.stack([silent, alarms], axis=-1), events)


def intervals(outcomes, resamples=400, confidence=0.95, seed=1):
    weights = bootstrap_weights(len(outcomes.points), resamples, np.random.default_rng(seed))
    counts = counts_at(outcomes.resampled(weights), 1.0)
    return {name: percentile_interval(getattr(counts, name), confidence) for name in SCORES}


def draw_outcomes(generator, series=60):
    """Outcomes of series whose recall differs from one to the next: 0.7 on average."""
    events = generator.integers(1, 6, size=series)
    hits = generator.binomial(events, generator.beta(3.5, 1.5, size=series))
    return outcomes_of(hits, generator.poisson(0.4, size=series), events - hits, events * 0)


def test_intervals_cover_the_true_score_as_often_as_they_say():
    generator = np.random.default_rng(3)
    covered = 0
    for repetition in range(300):
        low, high = intervals(draw_outcomes(generator), 300, 0.9, repetition)["recall"]
        covered += low <= 0.7 <= high
    assert 0.83 < covered / 300 < 0.95


def test_intervals_grow_with_the_confidence_and_hold_the_score():
    outcomes = draw_outcomes(np.random.default_rng(3))
    narrow, wide = intervals(outcomes, confidence=0.5), intervals(outcomes, confidence=0.99)
    whole = counts_at(outcomes.total(), 1.0)
    for name in SCORES:
        score = getattr(whole, name)
        assert wide[name][0] < narrow[name][0] < score < narrow[name][1] < wide[name][1]


def test_series_are_resampled_as_a_whole_and_undefined_resamples_left_out():
    # all points of a series share their fate: ten events in each of four series
    outcomes = outcomes_of([10, 10, 10, 0], [0] * 4, [0, 0, 0, 10])
    low, high = intervals(outcomes, 4000, 0.8)["recall"]
    # shares of good series among four: 0, 1/4, ..., 1, and nothing between them
    assert (low, high) == (0.5, 1.0)
    # one series in three has the only event
    some = intervals(outcomes_of([1, 0, 0], [0, 0, 0], [0, 0, 0]))
    assert some["recall"] == (1.0, 1.0)
    nothing = intervals(outcomes_of([0, 0], [0, 0], [0, 0]))
    for name in SCORES:
        assert np.isnan(nothing[name]).all()
