"""Honest forecasts of the training series: each series by a forecaster that has not learnt from it.

What is calibrated with them has seen nothing but the training series.
"""

from collections.abc import Callable, Iterator
from typing import Protocol, Self, TypeVar

import numpy as np

from burstcast.arrays import BoolArray, FloatArray, IntArray
from burstcast.forecast.windows import WindowSummaries, forecast_summaries
from burstcast.forecasters.base import Forecaster, ForecastingCase


class Learner(Protocol):
    """Whatever can be told what it would be without one of the series that it has learnt from."""

    def leave_one_out(
        self, training: FloatArray, case: ForecastingCase, washout: int
    ) -> Iterator[Self]:
        """Forecasters without one series each (`burstcast.forecasters.base.Forecaster`)."""


L = TypeVar("L", bound=Learner)


def without_series(
    learner: L, training: FloatArray, case: ForecastingCase, washout: int, series: IntArray
) -> Iterator[tuple[IntArray, L]]:
    """Go through the series that starting points lie in: these points, and who has not seen it.

    Parameters are those of `leave_one_out_summaries`.
    """
    for row, without in enumerate(learner.leave_one_out(training, case, washout)):
        here = np.flatnonzero(series == row)
        if here.size:
            yield here, without


def leave_one_out_summaries(
    forecaster: Forecaster,
    training: FloatArray,
    case: ForecastingCase,
    washout: int,
    observable: Callable[[FloatArray], FloatArray],
    washouts: FloatArray,
    series: IntArray,
    boundaries: tuple[int, ...],
) -> tuple[WindowSummaries, BoolArray]:
    """Forecast from starting points in the training series, without what their series taught.

    Parameters
    ----------
    forecaster
        Who forecasts, trained on all of the series.
    training
        What it has learnt from, ``(series, time, dimension)``.
    case, washout
        What it knew beside that (`Forecaster.leave_one_out`).
    observable
        From states ``(dimension, ...)`` to the observable ``(...)``.
    washouts
        What is seen up to each starting point, ``(points, steps, dimension)``.
    series
        Row of each point's series, ``(points,)``.
    boundaries
        Of the windows (`burstcast.forecast.windows.window_boundaries`).

    Returns
    -------
    Summaries, and which forecasts have diverged, ``(points,)``.
    """
    windows = len(boundaries) - 1
    first = np.full((len(series), windows), np.nan)
    largest = np.full((len(series), windows), np.nan)
    diverged = np.zeros(len(series), dtype=bool)
    for here, without in without_series(forecaster, training, case, washout, series):
        summaries, lost = forecast_summaries(without, observable, washouts[here], boundaries)
        first[here], largest[here] = summaries.first, summaries.largest
        diverged[here] = lost
    return WindowSummaries(first, largest), diverged
