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
    parameters: FloatArray | None = None,
    schedules: FloatArray | None = None,
) -> WindowForecasts:
    """Forecast from starting points in the training series, refitted without the point's series.

    ``washouts``, ``series``: Washout of each point, ``(points, steps, dimension)``, and row of its
    training series. ``parameters``, ``schedules``: Of the training series, and of each point.
    """
    rows, parts = [], []
    refitted_without = forecaster.leave_one_out(training, case, washout, parameters)
    for row, refitted in enumerate(refitted_without):
        here = np.flatnonzero(series == row)
        if here.size:
            in_force = None if schedules is None else schedules[here]
            rows.append(here)
            parts.append(
                window_forecasts(refitted, observable, washouts[here], boundaries, in_force)
            )
    order = np.argsort(np.concatenate(rows))
    forecasts = joined(parts)
    return WindowForecasts(**{name: values[order] for name, values in vars(forecasts).items()})
