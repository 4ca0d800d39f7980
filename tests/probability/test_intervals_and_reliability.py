"""Intervals over series, and the bars of the reliability diagram, against sampling in full."""

import numpy as np
import pytest
from helpers_probability import count_by_series, informative_sample

from burstcast.probability.brier import brier_skill
from burstcast.probability.intervals import ratio_with_interval
from burstcast.probability.reliability import reliability_diagram
from burstcast.probability.scores import probability_scores
from burstcast.statistics.resampling import bootstrap_weights, percentile_interval


def test_a_ratio_of_sums_is_resampled_series_by_series():
    generator = np.random.default_rng(5)
    top, bottom = generator.random(30), generator.random(30) + 1
    weights = bootstrap_weights(30, 400, generator)
    value, low, high = ratio_with_interval(top, bottom, weights, 0.9)
    assert value == pytest.approx(top.sum() / bottom.sum())
    ratios = [
        sum(w * t for w, t in zip(row, top, strict=True))
        / sum(w * b for w, b in zip(row, bottom, strict=True))
        for row in weights
    ]
    assert [low, high] == pytest.approx(np.quantile(ratios, [0.05, 0.95]).tolist())


def test_clustered_events_widen_the_interval():
    # ten series behave as one: their points are no independent evidence
    probability, happened, _ = informative_sample()
    generator = np.random.default_rng(6)

    def width(series, count):
        found = count_by_series(probability, happened, series, count)
        skill = brier_skill(found.resampled(bootstrap_weights(count, 500, generator)))
        low, high = percentile_interval(skill, 0.9)
        return high - low

    order = np.argsort(np.abs(happened - probability), kind="stable")
    clustered = np.empty(1000, dtype=np.int64)
    clustered[order] = np.arange(1000) // 100
    assert width(clustered, 10) > 2 * width(np.arange(1000), 1000)


def test_all_scores_of_the_whole_are_those_of_one_resample_with_every_series_once():
    found = count_by_series(*informative_sample(), number=40)
    whole = probability_scores(found.total(), 0.4, 10)
    once = probability_scores(found.resampled(np.ones((1, 40), dtype=np.int64)), 0.4, 10)
    assert whole.keys() == once.keys()
    for name, value in whole.items():
        np.testing.assert_array_equal(once[name], [value])


def bars(probability, happened, series, seed=1, confidence=0.9):
    outcomes = count_by_series(probability, happened, series, 40)
    generator = np.random.default_rng(seed)
    weights = bootstrap_weights(40, 2000, generator)
    return reliability_diagram(outcomes, 5, weights, confidence, generator)


def test_the_bars_cover_a_reliable_forecaster_and_not_others():
    generator = np.random.default_rng(11)
    series = np.repeat(np.arange(40), 100)
    probability = generator.random(4000)
    covered = []
    for _ in range(20):
        diagram = bars(probability, generator.random(4000) < probability, series)
        frequency = diagram.whole.frequency
        covered += ((diagram.low <= frequency) & (frequency <= diagram.high)).tolist()
    assert 0.8 < np.mean(covered) < 0.97  # of 100 bars that cover with a probability of 0.9
    diagram = bars(probability, generator.random(4000) < probability**2, series)
    assert (diagram.whole.frequency[1:4] < diagram.low[1:4]).all()


def test_the_bars_have_the_width_of_a_binomial_distribution():
    # one probability, series of the same size: the count of events is binomial
    probability, series = np.full(4000, 0.3), np.repeat(np.arange(40), 100)
    diagram = bars(probability, np.zeros(4000, dtype=bool), series)
    deviation = np.sqrt(0.3 * 0.7 / 4000)
    assert diagram.low[1] == pytest.approx(0.3 - 1.645 * deviation, abs=0.1 * deviation)
    assert diagram.high[1] == pytest.approx(0.3 + 1.645 * deviation, abs=0.1 * deviation)
    assert np.isnan(diagram.low[[0, 2, 3, 4]]).all()
