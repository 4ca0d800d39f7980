"""Starting points of forecasts, and the events to predict.

Source: sections "Precision and recall" and "Prediction horizon of extreme events" of the paper.
"""

from dataclasses import dataclass

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.data.events import upward_crossings


@dataclass(frozen=True)
class SeriesPoints:
    """Points in the series of an ensemble."""

    series: IntArray  #: row of each point's series, ``(points,)``
    step: IntArray  #: its step within the series, ``(points,)``

    def __len__(self) -> int:
        return len(self.series)


def starting_points(
    series: int,
    length: int,
    spacing: int,
    washout: int,
    longest_forecast: int,
    *,
    lengths: IntArray | None = None,
) -> SeriesPoints:
    """Evenly spaced starting points, as many as leave room for the washout and the forecast.

    ``longest_forecast``: Steps that a forecast reaches beyond its starting point. ``lengths``:
    Samples of each series, where some are shorter than ``length``.
    """
    longest = length if lengths is None else int(lengths.max())
    steps = np.arange(washout - 1, longest - longest_forecast, spacing)
    if steps.size == 0:
        raise ValueError(
            f"series of {longest} samples leave no room for a washout of {washout} steps and a "
            f"forecast of {longest_forecast}: shorten the washout or the prediction times and "
            "window, or take longer series"
        )
    points = SeriesPoints(
        series=np.repeat(np.arange(series), steps.size), step=np.tile(steps, series)
    )
    if lengths is None:
        return points
    inside = points.step + longest_forecast < lengths[points.series]
    return SeriesPoints(points.series[inside], points.step[inside])


def crossing_points(observable: FloatArray, threshold: float) -> SeriesPoints:
    """Starts of the extreme events of series (`burstcast.data.events.upward_crossings`).

    ``observable``: ``(series, time)``.
    """
    series, step = np.nonzero(upward_crossings(observable, threshold))
    return SeriesPoints(series=series, step=step)


def horizon_events(
    crossings: SeriesPoints, first_series: int, earliest_step: int, count: int
) -> SeriesPoints:
    """First events of the series outside of training, with room before them.

    ``first_series``: Row of the first series that was not used for training. ``earliest_step``:
    Steps of their series that events leave before them, at least.
    """
    usable = (crossings.series >= first_series) & (crossings.step >= earliest_step)
    rows = np.flatnonzero(usable)[:count]
    return SeriesPoints(series=crossings.series[rows], step=crossings.step[rows])


def steps_before_events(length: int, longest_lead_time: int, washout: int) -> int:
    """Steps that a prediction horizon needs before an event: the longest lead time and its washout.

    ``longest_lead_time``, ``washout``: In steps; the last input of the washout is the starting
    point itself.
    """
    if washout + longest_lead_time > length:
        raise ValueError(
            f"series of {length} samples leave no room for a washout of {washout} steps and a "
            f"start {longest_lead_time} steps before an event"
        )
    return longest_lead_time + washout - 1


def segments(series: FloatArray, points: SeriesPoints, before: int, after: int) -> FloatArray:
    """Stretches of series around points, ``(points, before + 1 + after, ...)``.

    ``series``: ``(series, time, ...)``.
    """
    if len(points) and (points.step.min() < before or points.step.max() + after >= series.shape[1]):
        raise IndexError("a segment reaches beyond its series")
    window = np.arange(-before, after + 1)
    stretches: FloatArray = series[
        points.series[:, np.newaxis], points.step[:, np.newaxis] + window
    ]
    return stretches
