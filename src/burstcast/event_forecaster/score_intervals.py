"""Scores of an event forecaster with confidence intervals, and the outcomes that they are of."""

from typing import NamedTuple

import numpy as np

from burstcast.base import random_streams
from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.base.resampled_score import ResampledScore
from burstcast.base.resampling import bootstrap_weights, percentile_interval
from burstcast.data.starting_points import SeriesPoints
from burstcast.forecasts.scores import Outcomes, ratio, resampled_scores

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


def score_intervals(
    outcomes: Outcomes, threshold: float, bins: int, random_seed: int, invalid: FloatArray
) -> dict[str, ScoreInterval]:
    """Scores of `burstcast.forecasts.scores` with intervals of a bootstrap over blocks.

    ``outcomes``: By block, ``(blocks, levels)``. ``invalid``: Invalid forecasts in each block, in
    points that count, ``(blocks,)``.
    """
    generator = random_streams.stream(random_seed, "score intervals")
    weights = bootstrap_weights(len(outcomes.points), _RESAMPLES, generator)
    scores = resampled_scores(outcomes, weights, threshold, bins)
    value, samples = scores["base_rate"].value, scores["base_rate"].samples
    permanent = ResampledScore(2 * value / (1 + value), 2 * samples / (1 + samples))
    scores["permanent_f_score"] = permanent
    counts = {
        "forecasts": outcomes.points.sum(axis=1).astype(np.float64),
        "events": outcomes.events.sum(axis=1).astype(np.float64),
    }
    totals = {
        name: ResampledScore(float(count.sum()), weights @ count) for name, count in counts.items()
    }
    points = counts["forecasts"]
    lost = ratio(weights @ invalid, weights @ points)
    scores["invalid_fraction"] = ResampledScore(float(ratio(invalid.sum(), points.sum())), lost)
    scores = {**totals, **scores}
    return {
        name: ScoreInterval(float(score.value), *percentile_interval(score.samples, _CONFIDENCE))
        for name, score in scores.items()
    }
