"""Scores of forecasts: contingency tables, probabilities, ranking, reliability.

Forecasts are counted by series and forecast probability (`Outcomes`), so that intervals of scores
resample whole series: starting points of one series are not independent. Scores are functions of
the counts summed over series, and do not depend on the forecaster.

The largest observable that a trajectory reaches in a window ranks starting points more finely than
its crossing of the threshold. The *onset* is a crossing from below within the window; *any* time
above the threshold is easier: an event that is under way when the window begins counts.

Sources: section "Precision and recall" of the paper; Brier, Monthly Weather Review 78 (1950);
Murphy, Journal of Applied Meteorology 12 (1973); Stephenson, Coelho & Jolliffe, Weather and
Forecasting 23 (2008), for bins that hold several probabilities; Broecker & Smith, Weather and
Forecasting 22 (2007), for consistency bars, which resample the forecasts and draw outcomes as
likely as the forecasts say. Here whole series are resampled.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.base.resampled_score import ResampledScore
from burstcast.base.resampling import percentile_interval
from burstcast.forecasts.windows import WindowForecasts, WindowSummaries, crosses


@dataclass(frozen=True)
class Outcomes:
    """Counts of forecasts by their value."""

    #: distinct values of forecasts, rising, ``(levels,)``: probabilities, or any score that rises
    #: with the probability
    levels: FloatArray
    #: forecasts of each level, ``(..., levels)``: by series, summed over series, or by resample
    points: IntArray
    events: IntArray  #: forecasts of each level that an event followed, ``(..., levels)``

    def total(self) -> "Outcomes":
        """Sum over all series."""
        return Outcomes(self.levels, self.points.sum(axis=-2), self.events.sum(axis=-2))

    def resampled(self, weights: IntArray) -> "Outcomes":
        """Sums over resampled series, by their weights ``(resamples, series)``."""
        # counts are whole numbers below 2^53: exact, and BLAS computes the product
        factors = weights.astype(np.float64)
        return Outcomes(
            self.levels,
            np.rint(factors @ self.points).astype(np.int64),
            np.rint(factors @ self.events).astype(np.int64),
        )

    def at(self, values: FloatArray) -> "Outcomes":
        """Outcomes with new values, never falling, for the levels; levels of NaN are left out."""
        defined = ~np.isnan(values)
        if (np.diff(values[defined]) < 0).any():
            raise ValueError("values that fall would change the order of the forecasts")
        points, events = self.points[..., defined], self.events[..., defined]
        levels, first = np.unique(values[defined], return_index=True)
        if not levels.size:
            return Outcomes(levels, points, events)
        return Outcomes(
            levels,
            np.add.reduceat(points, first, axis=-1),
            np.add.reduceat(events, first, axis=-1),
        )


def outcomes_by_series(
    forecast: FloatArray, happened: BoolArray, scored: BoolArray, series: IntArray, count: int
) -> Outcomes:
    """Count the outcomes of forecasts in each of ``count`` series, ``(count, levels)``.

    ``forecast``, ``happened``, ``scored``, ``series``: Probability or score of each starting point,
    whether an event followed, whether it counts, and its series, ``(points,)``.
    """
    values, rows, true = forecast[scored], series[scored], happened[scored]
    if not np.isfinite(values).all():
        raise ValueError("a probability or score is not finite")
    levels, column = np.unique(values, return_inverse=True)
    shape = (count, levels.size)
    cell = rows * levels.size + column

    def tally(cells: IntArray) -> IntArray:
        counts = np.bincount(cells, minlength=shape[0] * shape[1]).astype(np.int64)
        return counts.reshape(shape)

    return Outcomes(levels, tally(cell), tally(cell[true]))


SCORES = ("precision", "recall", "f_score")
"""Names of the scores: properties of `ContingencyTable`."""


@dataclass(frozen=True)
class ContingencyTable:
    """How many forecasts of each outcome there are; integers, or arrays of one shape.

    Examples
    --------
    >>> from burstcast.forecasts.scores import ContingencyTable
    >>> counts = ContingencyTable(8, false_positive=2, false_negative=4, true_negative=86)
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
        """2 TP / (2 TP + FP + FN); NaN where nothing was predicted and nothing happened."""
        return ratio(
            2 * self.true_positive,
            2 * self.true_positive + self.false_positive + self.false_negative,
        )


def ratio(numerator: npt.ArrayLike, denominator: npt.ArrayLike) -> FloatArray:
    """Quotient that is NaN, without a warning, where the denominator is zero."""
    top = np.asarray(numerator, dtype=np.float64)
    bottom = np.asarray(denominator, dtype=np.float64)
    return np.divide(top, bottom, out=np.full_like(bottom, np.nan), where=bottom != 0)


def counts_at(outcomes: Outcomes, threshold: float) -> ContingencyTable:
    """Counts of alarms, raised where the forecast is at or above the threshold."""
    alarm = outcomes.levels >= threshold
    points, events = outcomes.points, outcomes.events
    quiet = points - events
    return ContingencyTable(
        true_positive=events[..., alarm].sum(axis=-1),
        false_positive=quiet[..., alarm].sum(axis=-1),
        false_negative=events[..., ~alarm].sum(axis=-1),
        true_negative=quiet[..., ~alarm].sum(axis=-1),
    )


def best_threshold(probabilities: FloatArray, points: IntArray) -> float:
    """Threshold whose alarms have the largest F-score that probabilities let expect.

    Of n forecasts of the probability p, n p are expected to come true, so that alarms from a level
    on have the F-score 2 sum_alarms(n p) / (sum_alarms(n) + sum(n p)) (Lewis, SIGIR 1995). The
    threshold is the middle between the level from which alarms are raised and the next lower one;
    of equally good ones it is the highest. It is 0 where alarms are raised always, and 1 where no
    event is expected at all.

    ``probabilities``, ``points``: Levels, rising, and forecasts of each, ``(levels,)``.
    """
    expected = points * probabilities
    whole = float(expected.sum())
    if whole == 0:
        return 1.0
    hits, raised = np.cumsum(expected[::-1]), np.cumsum(points[::-1])
    level = probabilities.size - 1 - int(np.argmax(2 * hits / (raised + whole)))
    if level == 0:
        return 0.0
    return float(probabilities[level - 1] + probabilities[level]) / 2


def useless_votes(outcomes: Outcomes) -> str:
    """Reason why votes carry no information about events; empty if they do.

    It is that the area below the receiver operating characteristic is within two standard errors of
    a half (Mann & Whitney, Ann. Math. Stat. 18, 1947), as if all points were independent.
    """
    events, points = int(outcomes.events.sum()), int(outcomes.points.sum())
    quiet = points - events
    if not events or not quiet:
        return f"an event follows {events} of {points} starting points: there is nothing to learn"
    area = float(roc_area(outcomes))
    error = float(np.sqrt((points + 1) / (12 * events * quiet)))
    if area > 0.5 + 2 * error:
        return ""
    return (
        f"votes do not tell the {events} starting points that an event follows from the {quiet} "
        f"others (area below the ROC curve {area:.2f}, chance 0.50 +- {error:.2f}): alarms are no "
        f"better than chance"
    )


def roc_area(outcomes: Outcomes) -> FloatArray:
    """Area below the receiver operating characteristic; NaN where all outcomes are alike.

    The probability that an event had a larger forecast than a quiet point, ties counting half.
    """
    quiet = outcomes.points - outcomes.events
    below = np.cumsum(quiet, axis=-1) - 0.5 * quiet
    pairs = outcomes.events.sum(axis=-1) * quiet.sum(axis=-1)
    return ratio((outcomes.events * below).sum(axis=-1), pairs)


def average_precision(outcomes: Outcomes) -> FloatArray:
    """Area below the precision-recall curve, in steps; NaN without events."""
    # alarms with each level as the threshold, from the highest
    gained, raised = outcomes.events[..., ::-1], outcomes.points[..., ::-1].cumsum(axis=-1)
    precision = np.nan_to_num(ratio(gained.cumsum(axis=-1), raised))
    return ratio((gained * precision).sum(axis=-1), outcomes.events.sum(axis=-1))


def base_rate(outcomes: Outcomes) -> FloatArray:
    """Share of the forecasts that an event followed; NaN without forecasts."""
    return ratio(outcomes.events.sum(axis=-1), outcomes.points.sum(axis=-1))


def brier_score(outcomes: Outcomes) -> FloatArray:
    """Mean square difference between probability and outcome (1: event, 0: none)."""
    levels, events = outcomes.levels, outcomes.events
    errors = events * (1 - levels) ** 2 + (outcomes.points - events) * levels**2
    return ratio(errors.sum(axis=-1), outcomes.points.sum(axis=-1))


def brier_skill(outcomes: Outcomes) -> FloatArray:
    """Brier skill score: 1 - Brier score / uncertainty of the sample.

    1 is perfect, 0 as good as climatology; NaN where all outcomes are alike. The climatology is the
    sample's own, which knows more than any forecaster could: the strictest reference.

    Examples
    --------
    >>> import numpy as np
    >>> from burstcast.forecasts.scores import brier_skill
    >>> from burstcast.forecasts.scores import Outcomes
    >>> outcomes = Outcomes(np.array([0.1, 0.9]), np.array([90, 10]), events=np.array([9, 9]))
    >>> round(float(brier_skill(outcomes)), 3)
    0.39
    """
    rate = base_rate(outcomes)
    return np.asarray(1 - ratio(brier_score(outcomes), rate * (1 - rate)))


@dataclass(frozen=True)
class Binned:
    """Outcomes in equally wide bins of the probability; arrays of shape ``(..., bins)``."""

    #: points, events: forecasts in each bin, and how many of them an event followed
    points: IntArray
    events: IntArray
    #: mean probability of the forecasts in the bin; NaN where there are none
    mean_probability: FloatArray

    @property
    def frequency(self) -> FloatArray:
        """Share of the forecasts in each bin that an event followed; NaN in empty bins."""
        return ratio(self.events, self.points)


def bin_of(levels: FloatArray, bins: int) -> IntArray:
    """Bin of each probability: bin i holds [i, i + 1) / bins; the last one also holds 1."""
    if ((levels < 0) | (levels > 1)).any():
        raise ValueError("probabilities lie between 0 and 1")
    # a share of votes that rounding has put just below its bin's edge belongs into that bin
    return np.minimum(np.floor(levels * bins + 1e-9), bins - 1).astype(np.int64)


def binned(outcomes: Outcomes, bins: int) -> Binned:
    """Gather outcomes in equally wide bins of the probability."""
    # bins rise with the levels: levels of a bin lie side by side
    present, first = np.unique(bin_of(outcomes.levels, bins), return_index=True)

    def gather(values: FloatArray | IntArray) -> npt.NDArray[Any]:
        sums = np.zeros((*values.shape[:-1], bins), dtype=values.dtype)
        if first.size:
            sums[..., present] = np.add.reduceat(values, first, axis=-1)
        return sums

    points, events = gather(outcomes.points), gather(outcomes.events)
    return Binned(points, events, ratio(gather(outcomes.points * outcomes.levels), points))


def decomposition(outcomes: Outcomes, bins: int) -> dict[str, FloatArray]:
    """Decompose the Brier score over equally wide bins of the probability.

    The score is reliability - resolution + uncertainty. ``reliability``: Mean square difference
    between a bin's probability and how often events followed: 0 is best. ``resolution``: How far
    the bins' frequencies lie from the base rate: large is good. It is the generalised one of
    Stephenson et al., which takes up what varies within bins, so that the parts add up.
    ``uncertainty``: Variance of the outcomes: the Brier score of climatology.
    """
    whole, rate = binned(outcomes, bins), base_rate(outcomes)
    count = outcomes.points.sum(axis=-1)
    # where a bin is empty, its terms are zero
    mean, frequency = np.nan_to_num(whole.mean_probability), np.nan_to_num(whole.frequency)
    reliability = (whole.points * (mean - frequency) ** 2).sum(axis=-1)
    between = (whole.points * (frequency - rate[..., np.newaxis]) ** 2).sum(axis=-1)
    column = bin_of(outcomes.levels, bins)
    offset = outcomes.levels - mean[..., column]
    variance = (outcomes.points * offset**2).sum(axis=-1)
    covariance = ((outcomes.events - outcomes.points * frequency[..., column]) * offset).sum(
        axis=-1
    )
    return {
        "reliability": ratio(reliability, count),
        "resolution": ratio(between - variance + 2 * covariance, count),
        "uncertainty": np.asarray(rate * (1 - rate)),
    }


def calibration_error(outcomes: Outcomes, bins: int) -> FloatArray:
    """Mean |mean probability - frequency| over the bins' forecasts (Naeini et al., AAAI 2015)."""
    whole = binned(outcomes, bins)
    gaps = whole.points * np.abs(np.nan_to_num(whole.mean_probability - whole.frequency))
    return ratio(gaps.sum(axis=-1), outcomes.points.sum(axis=-1))


def consistency_bars(
    outcomes: Outcomes,
    bins: int,
    weights: IntArray,
    confidence: float,
    generator: np.random.Generator,
) -> FloatArray:
    """Ends between which frequencies of a reliable forecaster would lie, ``(2, bins)``.

    ``outcomes``: By series, ``(series, levels)``.
    """
    resampled = outcomes.resampled(weights)
    drawn = generator.binomial(resampled.points, outcomes.levels)
    frequency = binned(Outcomes(outcomes.levels, resampled.points, drawn), bins).frequency
    return np.array([percentile_interval(of_bin, confidence) for of_bin in frequency.T]).T


ONSET, ANY = "onset", "any"
EVENTS = (ONSET, ANY)
"""What may happen in a window."""

PRECURSOR = "published_precursor"
"""What the quantity is called that theory gives (`DynamicalSystem.precursor`)."""


@dataclass(frozen=True)
class Window:
    """A prediction window: the first of the windows that make it up, and how many they are."""

    #: first, count: see `burstcast.forecasts.windows.crosses`
    first: int
    count: int
    threshold: float  #: the event threshold

    def happened(self, truth: WindowSummaries, event: str) -> BoolArray:
        """Whether the event happens in the window, ``(points,)``."""
        if event == ONSET:
            return crosses(truth, self.first, self.count, self.threshold)
        return np.asarray(self._largest(truth.largest) >= self.threshold)

    def strength(self, forecasts: WindowForecasts, event: str) -> FloatArray:
        """Largest observable that is forecast for the window, mean over members, ``(points,)``.

        A forecast that is not finite, or of an onset above the threshold when the window begins,
        ranks with the mean of all others.
        """
        strengths = [self._strength(member, event) for member in forecasts.members]
        return np.asarray(np.mean(strengths, axis=0))

    def _strength(self, forecast: WindowSummaries, event: str) -> FloatArray:
        largest = self._largest(forecast.largest)
        usable = np.isfinite(largest)
        if event == ONSET:
            usable &= forecast.first[:, self.first] < self.threshold
        mean = largest[usable].mean() if usable.any() else 0.0
        return np.where(usable, largest, mean)

    def _largest(self, values: FloatArray) -> FloatArray:
        largest: FloatArray = values[:, self.first : self.first + self.count].max(axis=1)
        return largest


def ranking_scores(
    strength: FloatArray, happened: BoolArray, weights: IntArray
) -> dict[str, FloatArray]:
    """Areas below the ROC curve and below the precision-recall curve, ``(resamples,)`` each.

    ``weights``: How often each point counts, ``(resamples, points)``. Points of equal strength are
    not distinguished. NaN where no event, or nothing but events, has a weight.
    """
    order = np.argsort(-strength, kind="stable")
    ends = np.flatnonzero(np.append(np.diff(strength[order]) != 0.0, True))
    counts = weights[:, order].astype(np.float64)
    alarms = counts.cumsum(axis=1)[:, ends]
    hits = (counts * happened[order]).cumsum(axis=1)[:, ends]
    events, others = hits[:, -1], alarms[:, -1] - hits[:, -1]
    false = alarms - hits
    new_hits = np.diff(hits, axis=1, prepend=0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        precision = np.where(alarms > 0.0, hits / alarms, 0.0)
        average = (new_hits * precision).sum(axis=1) / events
        # a hit ranks above all later false alarms, and half above false alarms of its own strength
        above = others[:, np.newaxis] - (false - np.diff(false, axis=1, prepend=0.0) / 2.0)
        area = (new_hits * above).sum(axis=1) / (events * others)
    undefined = (events == 0.0) | (others == 0.0)
    return {
        "roc_area": np.where(undefined, np.nan, area),
        "average_precision": np.where(undefined, np.nan, average),
    }


def probability_scores(outcomes: Outcomes, threshold: float, bins: int) -> dict[str, FloatArray]:
    """Score probabilities, and the alarms at or above a threshold; NaN where undefined.

    ``outcomes``: Summed over series, ``(levels,)``, or of resamples, ``(resamples, levels)``.
    ``bins``: Of the decomposition and of the calibration error.
    """
    counts = counts_at(outcomes, threshold)
    return {
        "base_rate": base_rate(outcomes),
        "brier_score": brier_score(outcomes),
        "brier_skill": brier_skill(outcomes),
        **decomposition(outcomes, bins),
        "calibration_error": calibration_error(outcomes, bins),
        "roc_area": roc_area(outcomes),
        "average_precision": average_precision(outcomes),
        "alarm_precision": counts.precision,
        "alarm_recall": counts.recall,
        "alarm_f_score": counts.f_score,
    }


def resampled_scores(
    outcomes: Outcomes, weights: IntArray, threshold: float, bins: int
) -> dict[str, ResampledScore]:
    """`probability_scores` of all series, ``(series, levels)``, and of resamples of them."""
    values = probability_scores(outcomes.total(), threshold, bins)
    samples = probability_scores(outcomes.resampled(weights), threshold, bins)
    return {name: ResampledScore(value, samples[name]) for name, value in values.items()}
