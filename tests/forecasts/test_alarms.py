"""Alarms, the choice of their threshold, curves over all thresholds, and lead times."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.metrics import (
    average_precision_score,
    confusion_matrix,
    f1_score,
    precision_score,
    recall_score,
    roc_auc_score,
)

from burstcast.data.starting_points import SeriesPoints
from burstcast.forecasts.alarms import isotonic
from burstcast.forecasts.lead_times import lead_time_scores, lead_times
from burstcast.forecasts.points import alarm_sources
from burstcast.forecasts.probabilities import EventProbabilities
from burstcast.forecasts.scores import (
    SCORES,
    Outcomes,
    average_precision,
    best_threshold,
    counts_at,
    roc_area,
    useless_votes,
)
from burstcast.forecasts.windows import WindowForecasts
from helpers_library import count_by_series, samples


@given(samples(), st.floats(0, 1))
def test_alarms_and_their_scores_are_those_of_the_points(sample, threshold):
    probability, happened, _ = sample
    counts, alarm = counts_at(count_by_series(*sample).total(), threshold), probability >= threshold
    matrix = confusion_matrix(happened, alarm, labels=[False, True])
    assert [counts.true_negative, counts.false_positive] == matrix[0].tolist()
    assert [counts.false_negative, counts.true_positive] == matrix[1].tolist()
    for score, reference in zip(SCORES, (precision_score, recall_score, f1_score), strict=True):
        expected = reference(happened, alarm, zero_division=np.nan)
        np.testing.assert_allclose(getattr(counts, score), expected, rtol=1e-14)


@given(samples())
def test_areas_are_those_of_scikit_learn(sample):
    probability, happened, _ = sample
    whole = count_by_series(*sample).total()
    if happened.any():
        expected = average_precision_score(happened, probability)
        np.testing.assert_allclose(average_precision(whole), expected, rtol=1e-12)
    else:
        assert np.isnan(average_precision(whole))
    if happened.any() and not happened.all():
        expected = roc_auc_score(happened, probability)
        np.testing.assert_allclose(roc_area(whole), expected, rtol=1e-12)
    else:
        assert np.isnan(roc_area(whole))


@given(samples(values=st.integers(0, 10).map(lambda votes: votes / 10)))
def test_after_plain_isotonic_regression_no_threshold_is_better(sample):
    probability, happened, _ = sample
    whole = count_by_series(*sample).total()
    calibrated = whole.at(isotonic(whole)(whole.levels))
    threshold = best_threshold(calibrated.levels, calibrated.points)
    if not happened.any():
        assert threshold == 1
        return
    reached = counts_at(calibrated, threshold).f_score
    # of the probabilities, and of the values that they come from
    best = max(f1_score(happened, probability >= value) for value in np.unique(probability))
    np.testing.assert_allclose(reached, best, rtol=1e-12)


@given(samples())
def test_the_best_threshold_maximises_what_probabilities_let_expect(sample):
    probability = sample[0]
    whole = count_by_series(*sample).total()
    threshold = best_threshold(whole.levels, whole.points)
    assert 0 <= threshold <= 1
    if not probability.any():
        assert threshold == 1
        return

    def expected(limit):
        alarm = probability >= limit
        return 2 * probability[alarm].sum() / (alarm.sum() + probability.sum())

    best = max(expected(value) for value in np.unique(probability))
    np.testing.assert_allclose(expected(threshold), best, rtol=1e-12)


def test_the_threshold_lies_between_the_levels():
    levels, points = np.array([0.0, 0.2, 0.8, 1.0]), np.array([100, 10, 5, 5])
    assert best_threshold(levels, points) == pytest.approx(0.5)
    # all alike: alarms always
    assert best_threshold(np.array([0.1]), np.array([50])) == 0
    assert best_threshold(np.array([0.0]), np.array([50])) == 1


# -- lead times ------------------------------------------------------------------------------------

WINDOWS = [(10, 30), (20, 40), (30, 50)]


def points(count, spacing=10, series=1):
    return SeriesPoints(
        np.repeat(np.arange(series), count), np.tile(np.arange(count), series) * spacing
    )


@given(st.integers(0, 2**31), st.sampled_from([0.0, 0.04]))
def test_lead_times_are_those_of_all_pairs(seed, share):
    generator = np.random.default_rng(seed)
    where = points(14, 7, series=3)
    alarms = generator.random((len(where), 3)) < 0.6
    scored = generator.random(len(where)) < 0.9
    events = SeriesPoints(*np.nonzero(generator.random((3, 100)) < share))
    measured = lead_times(alarms, WINDOWS, where, scored, events)
    expected = []
    for row, step in zip(events.series, events.step, strict=True):
        stayed = first = possible = 0
        unbroken = True
        for index in reversed(range(len(where))):
            lead = step - where.step[index]
            inside = [begin < lead <= end for begin, end in WINDOWS]
            if where.series[index] != row or not any(inside):
                continue
            if not scored[index]:
                break
            right = any(a and i for a, i in zip(alarms[index], inside, strict=True))
            unbroken &= right
            possible = lead
            first = lead if right else first
            stayed = lead if unbroken else stayed
        if possible:
            expected.append((row, stayed, first, possible))
    columns = (measured.series, measured.stayed, measured.first, measured.possible)
    assert list(zip(*(column.tolist() for column in columns), strict=True)) == expected
    if not expected:
        assert not any(s.denominator.any() for s in lead_time_scores(measured, 3, [1], 10))


def test_scores_of_lead_times():
    where = points(10, series=2)
    alarms = np.zeros((20, 3), dtype=bool)
    alarms[5:9] = True
    events = SeriesPoints(np.array([0, 1, 1]), np.array([95, 55, 95]))
    measured = lead_times(alarms, WINDOWS, where, np.ones(20, dtype=bool), events)
    scores = {
        (score.metric, score.lead_time_lt): score.numerator.sum() / score.denominator.sum()
        for score in lead_time_scores(measured, 2, [1, 2, 4.5], 10)
    }
    assert scores["mean_lead_time_lt", None] == pytest.approx(4.5 / 3)
    assert scores["mean_first_alarm_lt", None] == pytest.approx(4.5 / 3)
    assert scores["mean_possible_lead_time_lt", None] == pytest.approx(4.5)
    assert scores["missed_fraction", None] == pytest.approx(2 / 3)
    assert scores["warned_fraction", 2] == pytest.approx(1 / 3)
    (last,) = (s for s in lead_time_scores(measured, 2, [4.5], 10) if s.lead_time_lt)
    assert last.numerator.tolist() == [1, 0]
    assert last.denominator.tolist() == [1, 2]


# -- sources of alarms -----------------------------------------------------------------------------


def test_alarms_are_those_of_baselines_forecasters_and_committees():
    """A committee has several networks, which come first, or the members of one ensemble."""
    values, lost = np.zeros((4, 2)), np.zeros(4, dtype=bool)
    alone, ensemble = (
        WindowForecasts(values, values, lost, *np.zeros((2, 4, members, 2))) for members in (0, 3)
    )
    forecasts = {
        "analogues": ensemble,
        **dict.fromkeys(("esn-N50-RV-seed0", "esn-N50-RV-seed1", "esn-N50-SSV-seed0"), alone),
        "persistence": alone,
        "precursor": EventProbabilities(values, np.array([0.5, 1.0]), np.array([0.1])),
    }
    sources = {source.identifier: source for source in alarm_sources(forecasts)}
    committees = ["esn-N50-RV-committee", "analogues-committee"]
    assert list(sources) == ["climatology", "observable_now", *forecasts, *committees]
    assert [name for name, source in sources.items() if source.committee] == committees
    assert sources[committees[0]].forecasters == ("esn-N50-RV-seed0", "esn-N50-RV-seed1")
    assert [name for name, source in sources.items() if not source.compared] == list(forecasts)[1:4]


@pytest.mark.parametrize(
    ("events", "reason"),
    [
        # two standard errors from one half: an area of 0.616
        *(([19, 31], ""), ([20, 30], "area below the ROC curve 0.60, chance 0.50 +- 0.06")),
        *(([45, 5], "no better than chance"), ([0, 0], "0 of 100 starting points")),
    ],
)
def test_useless_votes(events, reason):
    outcomes = Outcomes(np.array([0.0, 1.0]), np.array([50, 50]), np.array(events))
    measured = useless_votes(outcomes)
    assert reason in measured
    assert bool(measured) == bool(reason)
