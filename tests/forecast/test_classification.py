"""Counts and scores against scikit-learn on the same truth values."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst
from sklearn.metrics import confusion_matrix, f1_score, precision_score, recall_score

from burstcast.forecast.classification import (
    Counts,
    bootstrap_interval,
    count_by_series,
    ratio,
    score_forecasts,
    total,
)
from burstcast.forecast.windows import WindowSummaries

POINTS = st.integers(1, 40)


def arrays(points, elements, dtype=bool):
    return npst.arrays(dtype, points, elements=elements)


@given(st.data(), POINTS)
def test_scores_are_those_of_scikit_learn(data, points):
    predicted, happened, scored = (data.draw(arrays(points, st.booleans())) for _ in range(3))
    series = np.sort(data.draw(arrays(points, st.integers(0, 5), np.int64)))
    counts = total(count_by_series(predicted, happened, scored, series))
    truth, forecast = happened[scored], predicted[scored]
    if not scored.any():
        assert np.isnan([counts.precision, counts.recall, counts.f_score]).all()
        return
    matrix = confusion_matrix(truth, forecast, labels=[False, True])
    assert [counts.true_negative, counts.false_positive] == matrix[0].tolist()
    assert [counts.false_negative, counts.true_positive] == matrix[1].tolist()
    for score, reference in (
        (counts.precision, precision_score),
        (counts.recall, recall_score),
        (counts.f_score, f1_score),
    ):
        expected = reference(truth, forecast, zero_division=np.nan)
        np.testing.assert_allclose(score, expected, rtol=1e-14)


@given(st.data(), POINTS)
def test_counts_of_a_series_are_those_of_its_points(data, points):
    predicted, happened, scored = (data.draw(arrays(points, st.booleans())) for _ in range(3))
    series = data.draw(arrays(points, st.integers(0, 5), np.int64))
    counts = count_by_series(predicted, happened, scored, series)
    assert len(counts.true_positive) == series.max() + 1
    for row in range(series.max() + 1):
        mine = (series == row) & scored
        assert counts.true_positive[row] == sum(predicted[mine] & happened[mine])
        assert counts.false_positive[row] == sum(predicted[mine] & ~happened[mine])
        assert counts.false_negative[row] == sum(~predicted[mine] & happened[mine])
        assert counts.true_negative[row] == sum(~predicted[mine] & ~happened[mine])


def counts_of(true_positive, false_positive, false_negative, true_negative=5):
    values = np.broadcast_arrays(true_positive, false_positive, false_negative, true_negative)
    return Counts(*(value.astype(np.int64) for value in values))


def test_ratios_of_arrays_and_numbers():
    np.testing.assert_array_equal(ratio([1, 0, 3], [2, 0, 0]), [0.5, np.nan, np.nan])
    assert ratio(1, 4) == 0.25
    assert np.isnan(ratio(1, 0))


def summaries(first, largest):
    return WindowSummaries(np.array(first, dtype=float), np.array(largest, dtype=float))


def test_forecast_and_truth_are_judged_alike_and_events_under_way_are_skipped():
    low, high = [0.05, 0.05, 0.05], [0.05, 0.2, 0.2]
    #            truth crosses     forecast crosses    washout
    cases = [
        (low, high, low, high, 0.05),  # true positive
        (low, low, low, high, 0.05),  # false positive
        (low, high, low, low, 0.05),  # false negative
        (low, low, low, low, 0.05),  # true negative
        (low, high, low, high, 0.1),  # skipped: the washout reaches the threshold
        (low, high, low, high, 0.5),  # skipped
        (low, high, low, high, np.nextafter(0.1, 0)),  # true positive
        (high, high, low, high, 0.05),  # the true event is under way: false positive
        (low, high, high, high, 0.05),  # the forecast one is: false negative
        (low, high, [np.nan] * 3, [np.nan] * 3, 0.05),  # lost forecast: false negative
        (low, low, [np.nan] * 3, [np.nan] * 3, 0.05),  # lost forecast: true negative
    ]
    truth = summaries([case[0] for case in cases], [case[1] for case in cases])
    forecast = summaries([case[2] for case in cases], [case[3] for case in cases])
    washouts, series = np.array([case[4] for case in cases]), np.arange(len(cases))
    where = {"first_window": 1, "windows": 2, "threshold": 0.1}
    counts = score_forecasts(forecast, truth, washouts, series, **where)
    assert counts.true_positive.tolist() == [1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0]
    assert counts.false_positive.tolist() == [0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0]
    assert counts.false_negative.tolist() == [0, 0, 1, 0, 0, 0, 0, 0, 1, 1, 0]
    assert counts.true_negative.tolist() == [0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1]


# -- bootstrap -------------------------------------------------------------------------------------


def intervals(counts, resamples=400, confidence=0.95, seed=1):
    return bootstrap_interval(counts, resamples, confidence, np.random.default_rng(seed))


def draw_counts(generator, series=60):
    """Counts of series whose recall differs from one to the next: 0.7 on average."""
    events = generator.integers(1, 6, size=series)
    found = generator.binomial(events, generator.beta(3.5, 1.5, size=series))
    return counts_of(found, generator.poisson(0.4, size=series), events - found, events * 0)


def test_intervals_cover_the_true_score_as_often_as_they_say():
    generator = np.random.default_rng(3)
    covered = 0
    for repetition in range(300):
        low, high = intervals(draw_counts(generator), 300, 0.9, repetition)["recall"]
        covered += low <= 0.7 <= high
    assert 0.83 < covered / 300 < 0.95


def test_intervals_are_those_of_the_generator_grow_with_the_confidence_and_hold_the_score():
    counts = draw_counts(np.random.default_rng(3))
    narrow, wide = intervals(counts, confidence=0.5), intervals(counts, confidence=0.99)
    whole = total(counts)
    for name in ("precision", "recall", "f_score"):
        score = getattr(whole, name)
        assert wide[name][0] < narrow[name][0] < score < narrow[name][1] < wide[name][1]
    counts = draw_counts(np.random.default_rng(3))
    assert intervals(counts, seed=7) == intervals(counts, seed=7)
    assert intervals(counts, seed=7) != intervals(counts, seed=8)


def test_series_are_resampled_as_a_whole_and_undefined_resamples_left_out():
    # all points of a series share their fate: ten events in each of four series
    counts = counts_of([10, 10, 10, 0], [0] * 4, [0, 0, 0, 10])
    low, high = intervals(counts, 4000, 0.8)["recall"]
    # shares of good series among four: 0, 1/4, ..., 1, and nothing between them
    assert (low, high) == (0.5, 1.0)
    # one series in three has the only event
    some = intervals(counts_of([1, 0, 0], [0, 0, 0], [0, 0, 0]))
    assert some["recall"] == (1.0, 1.0)
    nothing = intervals(counts_of([0, 0], [0, 0], [0, 0]))
    for name in ("precision", "recall", "f_score"):
        assert np.isnan(nothing[name]).all()
