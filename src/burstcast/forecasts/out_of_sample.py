"""Forecasts of each training series by a forecaster that was fitted without it."""

from collections.abc import Callable

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray
from burstcast.forecasters.base import Forecaster, ForecastingCase
from burstcast.forecasts.window_forecasts import joined, window_forecasts
from burstcast.forecasts.windows import WindowForecasts


def out_of_sample_forecasts(
    forecaster: Forecaster,
    training: FloatArray,
    case: ForecastingCase,
    washout: int,
    observable: Callable[[FloatArray], FloatArray],
    washouts: FloatArray,
    series: IntArray,
    boundaries: tuple[int, ...],
) -> WindowForecasts:
    """Forecast from starting points in the training series, refitted without the point's series.

    ``training``, ``case``, ``washout``: Arguments of `Forecaster.leave_one_out`. ``washouts``,
    ``series``: Washout of each point, ``(points, steps, dimension)``, and row of its training
    series, ``(points,)``.
    """
    rows, parts = [], []
    for row, refitted in enumerate(forecaster.leave_one_out(training, case, washout)):
        here = np.flatnonzero(series == row)
        if here.size:
            rows.append(here)
            parts.append(window_forecasts(refitted, observable, washouts[here], boundaries))
    order = np.argsort(np.concatenate(rows))
    forecasts = joined(parts)
    return WindowForecasts(**{name: values[order] for name, values in vars(forecasts).items()})
