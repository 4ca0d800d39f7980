"""Lead times of alarms before events.

Forecasts are made at starting points along a series; each raises alarms for several windows ahead.
A starting point is right about an event if one of its alarms is for a window that holds it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from burstcast.base import durations
from burstcast.base.arrays import BoolArray, FloatArray, IntArray
from burstcast.base.resampling import percentile_interval
from burstcast.data.starting_points import SeriesPoints
from burstcast.forecasts.scores import ratio


@dataclass(frozen=True)
class LeadTimes:
    """Lead times of alarms before each event, in steps; arrays of shape ``(events,)``."""

    series: IntArray  #: row of each event's series
    #: time from the first starting point after which all were right to the event; 0 if the last one
    #: before it was not
    stayed: IntArray
    #: time from the first starting point that was right at all; 0 if there was none
    first: IntArray
    possible: IntArray  #: time from the first starting point that could have been right


def lead_times(
    alarms: BoolArray,
    windows: Sequence[tuple[int, int]],
    points: SeriesPoints,
    scored: BoolArray,
    events: SeriesPoints,
) -> LeadTimes:
    """Measure the lead time of alarms before each event that a starting point could have warned of.

    Going back from an event, the starting points end where the observed washout already holds an
    event, or where no window reaches any more. ``alarms``: By starting point, in the order of time,
    ``(points, windows)``. ``windows``: First and last step of each window after the starting point;
    it holds an event that crosses the threshold after the first step and not after the last one.
    ``scored``: Whether no event is under way at a point. ``events``: Starts of the events.
    """
    begins, ends = np.array(windows, dtype=np.int64).reshape(-1, 2).T
    measured = []
    for row in np.unique(events.series).tolist():
        here = np.flatnonzero(points.series == row)
        for event in events.step[events.series == row].tolist():
            lead = event - points.step[here]
            inside = (begins < lead[:, np.newaxis]) & (lead[:, np.newaxis] <= ends)
            # from the event backwards, up to the first point at which another is under way
            able = np.flatnonzero(inside.any(axis=1))[::-1]
            free = np.logical_and.accumulate(scored[here[able]])
            able = able[free]
            if able.size == 0:
                continue
            right = (alarms[here[able]] & inside[able]).any(axis=1)
            leads = lead[able]
            stayed = np.logical_and.accumulate(right)
            longest = [leads[mask].max(initial=0) for mask in (stayed, right)]
            measured.append((row, *longest, leads.max()))
    return LeadTimes(*np.array(measured, dtype=np.int64).reshape(-1, 4).T)


@dataclass(frozen=True)
class SeriesRatio:
    """A score that is the ratio of two sums over series."""

    metric: str
    lead_time_lt: float | None  #: lead time that it belongs to, in Lyapunov times; None: to none
    #: numerator, denominator: by series, ``(series,)``
    numerator: FloatArray
    denominator: FloatArray

    def with_interval(self, weights: IntArray, confidence: float) -> dict[str, float]:
        """The ratio, and the ends of its interval over series that are resampled by weights."""
        value = ratio(self.numerator.sum(), self.denominator.sum())
        factors = weights.astype(np.float64)
        samples = ratio(factors @ self.numerator, factors @ self.denominator)
        low, high = percentile_interval(samples, confidence)
        return {"value": float(value), "low": low, "high": high}


def lead_time_scores(
    measured: LeadTimes, series: int, lead_times_lt: Sequence[float], steps_per_lyapunov_time: int
) -> list[SeriesRatio]:
    """Scores of lead times.

    Means of `LeadTimes` over the events, in Lyapunov times; the fraction of missed events; and for
    each lead time the fraction of warned events, of the events that could be warned of so early.
    """

    def total(of_events: npt.ArrayLike) -> FloatArray:
        sums = np.bincount(measured.series, weights=np.asarray(of_events), minlength=series)
        return np.asarray(sums, dtype=np.float64)

    unit, events = steps_per_lyapunov_time, total(np.ones(len(measured.series)))
    scores = [
        SeriesRatio("mean_lead_time_lt", None, total(measured.stayed / unit), events),
        SeriesRatio("mean_first_alarm_lt", None, total(measured.first / unit), events),
        SeriesRatio("mean_possible_lead_time_lt", None, total(measured.possible / unit), events),
        SeriesRatio("missed_fraction", None, total(measured.stayed == 0), events),
    ]
    for time in lead_times_lt:
        steps = durations.steps(time, unit)
        warned, possible = total(measured.stayed >= steps), total(measured.possible >= steps)
        scores.append(SeriesRatio("warned_fraction", time, warned, possible))
    return scores
