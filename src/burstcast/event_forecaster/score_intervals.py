"""Scores of an event forecaster with confidence intervals, and the outcomes that they are of."""

from typing import NamedTuple

import numpy as np

from burstcast.base import random_streams
from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.base.resampled_score import ResampledScore
from burstcast.base.resampling import bootstrap_weights, loss_interval, percentile_interval
from burstcast.data.starting_points import SeriesPoints
from burstcast.forecasts.scores import (
    Outcomes,
    probability_scores,
    ratio,
    resampled_scores,
)

_CONFIDENCE, _RESAMPLES = 0.95, 1000
_LEAST_SERIES = 10
"""Series that are resampled as they are; fewer of them are cut into blocks of time."""
_BLOCKS = 20
"""Blocks of time that few series are cut into, at most."""


class EventOutcomes(NamedTuple):
    """Outcomes at starting points of forecasts; arrays ``(points,)``."""

    happened: BoolArray  #: whether an event followed
    probability: FloatArray  #: probability of an event
    series: IntArray  #: row of the series of each starting point
    time: FloatArray  #: time from the first sample of its series, in units of the sampling interval


class ScoreInterval(NamedTuple):
    """A score with the ends of its confidence interval of 95 %."""

    value: float
    low: float
    high: float


def blocks_of(points: SeriesPoints, reach: int) -> IntArray:
    """Block of each starting point, counted from 0: its series, or a stretch of time in it.

    ``reach``: Steps to the end of the last prediction window. Blocks of time are no shorter, so
    that forecasts in a block have little to do with those of blocks beyond the next one.

    Examples
    --------
    >>> blocks_of(SeriesPoints(np.zeros(6, int), np.arange(0, 60, 10)), reach=20).tolist()
    [0, 0, 1, 1, 2, 2]
    """
    if len(np.unique(points.series)) >= _LEAST_SERIES:
        return np.asarray(np.unique(points.series, return_inverse=True)[1])
    spans = [np.ptp(points.step[points.series == row]) + 1 for row in np.unique(points.series)]
    length = max(reach, -(-int(sum(spans)) // _BLOCKS))
    numbered = points.series * (int(points.step.max()) // length + 1) + points.step // length
    return np.asarray(np.unique(numbered, return_inverse=True)[1])


AT_MOST_ONE = (
    *("alarm_f_score", "alarm_precision", "alarm_recall"),
    *("brier_skill", "roc_area", "average_precision"),
)
"""Scores that are 1 without an error: their distance from 1 is a loss."""
LOSSES = ("base_rate", "brier_score", "invalid_fraction")
"""Scores that are 0 where nothing happens, or without an error."""
WITHOUT_INTERVAL = ("calibration_error", "reliability")
"""Scores that grow with the scatter of the sample: no interval that resamples it holds."""


def score_intervals(
    outcomes: Outcomes, threshold: float, bins: int, random_seed: int, invalid: FloatArray
) -> dict[str, ScoreInterval]:
    """Scores of `burstcast.forecasts.scores` with intervals over blocks.

    Scores that have a largest or a least value (`AT_MOST_ONE`, `LOSSES`) have the interval of
    `loss_interval`, others that of a bootstrap; those of `WITHOUT_INTERVAL` have none (NaN).
    benchmarks/score_intervals.py simulates how often intervals hold the truth.

    ``outcomes``: By block, ``(blocks, levels)``. ``invalid``: Invalid forecasts in each block, in
    points that count, ``(blocks,)``.
    """
    blocks = len(outcomes.points)
    generator = random_streams.stream(random_seed, "score intervals")
    weights = bootstrap_weights(blocks, _RESAMPLES, generator)
    points = outcomes.points.sum(axis=1).astype(np.float64)
    counts = {"forecasts": points, "events": outcomes.events.sum(axis=1).astype(np.float64)}

    def drawn(weights: IntArray) -> dict[str, ResampledScore]:
        scores = resampled_scores(outcomes, weights, threshold, bins)
        for name, count in counts.items():
            scores[name] = ResampledScore(float(count.sum()), weights @ count)
        lost = ratio(invalid.sum(), points.sum()), ratio(weights @ invalid, weights @ points)
        scores["invalid_fraction"] = ResampledScore(float(lost[0]), lost[1])
        return scores

    bootstrapped = drawn(weights)
    left_out = drawn(1 - np.eye(blocks, dtype=np.int64))
    more = probability_scores(_one_more(outcomes.total()), threshold, bins)
    more["invalid_fraction"] = ratio([invalid.sum() + 1], [points.sum() + 1])
    intervals = {}
    for name, score in bootstrapped.items():
        value, others = float(score.value), left_out[name].samples
        if name in WITHOUT_INTERVAL or blocks < 2:
            low, high = np.nan, np.nan
        elif name in AT_MOST_ONE:
            far, near = loss_interval(1 - value, 1 - others, 1 - more[name].min(), _CONFIDENCE)
            low, high = 1 - near, 1 - far
            low = low if name == "brier_skill" else max(low, 0.0)
        elif name in LOSSES:
            low, high = loss_interval(value, others, float(more[name].max()), _CONFIDENCE)
            high = min(high, 1.0)
        else:
            low, high = percentile_interval(score.samples, _CONFIDENCE)
        intervals[name] = ScoreInterval(value, low, high)
    rates = np.array(intervals["base_rate"])
    intervals["permanent_f_score"] = ScoreInterval(*(2 * rates / (1 + rates)).tolist())
    first = [*counts, "base_rate"]
    return {name: intervals[name] for name in [*first, *intervals]}


def _one_more(outcomes: Outcomes) -> Outcomes:
    """Outcomes with one more event at the lowest level, or none at the highest: ``(2, levels)``."""
    points, events = (np.stack([counts] * 2) for counts in (outcomes.points, outcomes.events))
    if outcomes.levels.size:
        points[0, 0] += 1
        events[0, 0] += 1
        points[1, -1] += 1
    return Outcomes(outcomes.levels, points, events)
