"""Ranking of starting points by the danger of an event: scores without any threshold.

The largest observable that a trajectory reaches in a window ranks starting points more finely than
its crossing of the threshold. The *onset* is a crossing from below within the window; *any* time
above the threshold is easier: an event that is under way when the window begins counts.
"""

from dataclasses import dataclass

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.forecasts.windows import WindowForecasts, WindowSummaries, crosses

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
