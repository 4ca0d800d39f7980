"""Binary classification of extreme events: counts, precision, recall, F-score, their intervals.

Source: section "Precision and recall" of the paper. Scoring does not depend on the forecaster.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from burstcast.arrays import BoolArray, FloatArray, IntArray
from burstcast.forecast.windows import WindowSummaries, crosses
from burstcast.statistics.resampling import bootstrap_weights, percentile_interval

SCORES = ("precision", "recall", "f_score")
"""Names of the scores: properties of `Counts`."""


@dataclass(frozen=True)
class Counts:
    """Outcomes of forecasts; integers, or arrays of one shape.

    Attributes
    ----------
    true_positive, false_positive, false_negative, true_negative
        How many forecasts of each kind there are.

    Examples
    --------
    >>> from burstcast.forecast.classification import Counts
    >>> counts = Counts(true_positive=8, false_positive=2, false_negative=4, true_negative=86)
    >>> float(counts.precision), round(float(counts.recall), 3), round(float(counts.f_score), 3)
    (0.8, 0.667, 0.727)
    """

    true_positive: IntArray
    false_positive: IntArray
    false_negative: IntArray
    true_negative: IntArray

    @property
    def precision(self) -> FloatArray:
        """TP / (TP + FP); NaN without any alarm."""
        return ratio(self.true_positive, self.true_positive + self.false_positive)

    @property
    def recall(self) -> FloatArray:
        """TP / (TP + FN); NaN without any event."""
        return ratio(self.true_positive, self.true_positive + self.false_negative)

    @property
    def f_score(self) -> FloatArray:
        """2 / (1 / precision + 1 / recall) = 2 TP / (2 TP + FP + FN).

        NaN where nothing was predicted and nothing happened.
        """
        return ratio(
            2 * self.true_positive,
            2 * self.true_positive + self.false_positive + self.false_negative,
        )


def ratio(numerator: npt.ArrayLike, denominator: npt.ArrayLike) -> FloatArray:
    """Quotient that is NaN, without a warning, where the denominator is zero."""
    top = np.asarray(numerator, dtype=np.float64)
    bottom = np.asarray(denominator, dtype=np.float64)
    return np.divide(top, bottom, out=np.full_like(bottom, np.nan), where=bottom != 0)


def count_by_series(
    predicted: BoolArray, happened: BoolArray, scored: BoolArray, series: IntArray
) -> Counts:
    """Outcomes in each test series.

    ``predicted``, ``happened``: Whether the forecast, and the truth, cross the threshold in the
    window, ``(points,)``. ``series``: Row of each point's series, ``(points,)``, from 0. Returns
    counts of shape ``(series,)``.
    """
    number = int(series.max()) + 1 if series.size else 0

    def tally(outcome: BoolArray) -> IntArray:
        return np.bincount(series[outcome & scored], minlength=number).astype(np.int64)

    return Counts(
        true_positive=tally(predicted & happened),
        false_positive=tally(predicted & ~happened),
        false_negative=tally(~predicted & happened),
        true_negative=tally(~predicted & ~happened),
    )


def score_forecasts(
    forecast: WindowSummaries,
    truth: WindowSummaries,
    washout_maximum: FloatArray,
    series: IntArray,
    *,
    first_window: int,
    windows: int,
    threshold: float,
) -> Counts:
    """Outcomes in each test series at one prediction time.

    A starting point is skipped where the observed washout already reaches the threshold: an event
    that is under way needs no forecast.

    ``washout_maximum``: Largest observable of each observed washout, ``(points,)``. Returns counts
    of shape ``(series,)``.
    """
    return count_by_series(
        predicted=crosses(forecast, first_window, windows, threshold),
        happened=crosses(truth, first_window, windows, threshold),
        scored=washout_maximum < threshold,
        series=series,
    )


def total(counts: Counts) -> Counts:
    """Sum of counts over their last axis."""
    return _map(counts, lambda values: values.sum(axis=-1))


def bootstrap_interval(
    counts: Counts, resamples: int, confidence: float, generator: np.random.Generator
) -> dict[str, tuple[float, float]]:
    """Percentile bootstrap intervals of all `SCORES`, resampled over series.

    Starting points of one series are not independent, whole series are.

    ``counts``: By series, ``(series,)``. ``confidence``: Share of the samples inside the interval,
    in (0, 1). Returns lower and upper end for each score; NaN where it is undefined in every
    resample.
    """
    series = counts.true_positive.shape[-1]
    weights = bootstrap_weights(series, resamples, generator)
    resampled = _map(counts, lambda values: weights @ values)
    return {name: percentile_interval(getattr(resampled, name), confidence) for name in SCORES}


def _map(counts: Counts, function: Callable[[IntArray], IntArray]) -> Counts:
    return Counts(
        true_positive=function(counts.true_positive),
        false_positive=function(counts.false_positive),
        false_negative=function(counts.false_negative),
        true_negative=function(counts.true_negative),
    )
