"""Starting points in series: observations up to each, and the true continuation."""

from collections.abc import Callable
from dataclasses import dataclass

from burstcast.base.arrays import FloatArray
from burstcast.base.series_lengths import series_lengths
from burstcast.data.starting_points import SeriesPoints, segments, starting_points
from burstcast.forecasts.windows import WindowSummaries, summarise


@dataclass(frozen=True)
class ObservedPoints:
    """Starting points with washouts and true continuations."""

    points: SeriesPoints
    #: observed states up to and including each point, ``(points, steps, component)``
    washouts: FloatArray
    seen: FloatArray  #: observed observable of the washouts, ``(points, steps)``
    truth: WindowSummaries  #: window summaries of the true observable


def observed_points(
    observed: FloatArray,
    true_observable: FloatArray,
    observable: Callable[[FloatArray], FloatArray],
    *,
    spacing: int,
    washout: int,
    boundaries: tuple[int, ...],
) -> ObservedPoints:
    """Evenly spaced starting points (`starting_points`) of observed series.

    ``observed``: ``(series, time, component)``. ``true_observable``: ``(series, time)``, which
    forecasts are scored against.
    """
    series, length = true_observable.shape
    lengths = series_lengths(observed)
    points = starting_points(series, length, spacing, washout, boundaries[-1], lengths=lengths)
    washouts = segments(observed, points, washout - 1, 0)
    return ObservedPoints(
        points,
        washouts,
        observable(washouts.transpose(2, 0, 1)),
        summarise(segments(true_observable, points, 0, boundaries[-1])[:, 1:].T, boundaries),
    )
