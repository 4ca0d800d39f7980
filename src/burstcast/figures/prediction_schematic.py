"""One forecast of the example network with its parts: washout, prediction time, and the window
that is classified.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from burstcast.arrays import FloatArray
from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast.figures.parts.observable_axis import axis_floor
from burstcast.figures.parts.spans import draw_span
from burstcast.figures.parts.style import (
    BLUE,
    DOUBLE_COLUMN,
    GREY,
    LIGHT_GREY,
    NETWORK,
    TRUTH,
    VERMILLION,
    WINDOW,
    draw_threshold,
    legend_above,
    new_figure,
    observable_label,
    styled,
)
from burstcast.figures.registry import Declaration

FIGURE = Declaration(
    section="forecasts",
    position=10,
    inputs={"examples": "example/examples.nc"},
    settings={
        "threshold": "case.event_threshold",
        "prediction_time_lt": "figures.example_prediction_time_lt",
        "washout_lt": "washout_lt",
        "window_lt": "classification.window_lt",
        "symbol": "shown.symbol",
    },
)


def draw(
    *,
    examples: Mapping[str, Any],
    threshold: float,
    prediction_time_lt: float,
    washout_lt: float,
    window_lt: float,
    symbol: str,
) -> Figure:
    """Draw the first example: a true positive, if there was one."""
    if not len(examples["outcome"]):
        return nothing_to_show("No event occurred in the test set, and none was predicted.")
    return prediction_schematic(
        examples["example_time_lt"],
        examples["example_truth"][0],
        examples["example_forecast"][0],
        threshold,
        prediction_time_lt,
        washout_lt=washout_lt,
        window_lt=window_lt,
        symbol=symbol,
    )


@styled
def prediction_schematic(
    time_lt: FloatArray,
    true: FloatArray,
    forecast: FloatArray,
    threshold: float,
    prediction_time_lt: float,
    *,
    washout_lt: float,
    window_lt: float = 1.0,
    symbol: str = "k",
) -> Figure:
    """Draw one real forecast with the names of its parts.

    ``time_lt``, ``true``, ``forecast``: ``(time,)``; the forecast starts at 0 and is NaN before.
    Time should begin before the washout does; the truth is NaN where the series has not begun.
    """
    figure = new_figure(DOUBLE_COLUMN, 2.5)
    axes = figure.subplots()
    floor = axis_floor(true, forecast)
    room = float(np.nanmax(true)) - floor
    window = (prediction_time_lt, prediction_time_lt + window_lt)
    axes.axvspan(*window, color=LIGHT_GREY, alpha=0.55, linewidth=0, zorder=0.5)
    for edge in window:
        axes.axvline(edge, **WINDOW)
    axes.axvspan(
        -washout_lt,
        0,
        facecolor="none",
        edgecolor=LIGHT_GREY,
        hatch="//////",
        linewidth=0,
        zorder=0.5,
    )
    axes.axvline(0, color=VERMILLION, linewidth=0.9, linestyle=":")
    draw_threshold(axes, threshold, f"${symbol}_e$")
    axes.plot(time_lt, true, label=rf"${symbol}_{{\mathrm{{True}}}}$", **TRUTH)
    axes.plot(time_lt, forecast, label=rf"${symbol}_{{\mathrm{{ESN}}}}$", **NETWORK)
    axes.plot(0, true[abs(time_lt).argmin()], "o", color=VERMILLION, ms=4.5, zorder=4)
    height = floor + 1.18 * room
    draw_span(axes, -washout_lt, 0, height, "washout\n(open loop)", GREY, to_the_left=True)
    draw_span(axes, 0, prediction_time_lt, height, "prediction time (closed loop)", VERMILLION)
    draw_span(axes, *window, height, f"event here?\nwindow, {window_lt:g} LT", BLUE)
    axes.set_ylim(floor, floor + 1.5 * room)
    axes.set_xlim(float(time_lt[0]), float(time_lt[-1]))
    axes.set_xlabel("Time from the start of the forecast [LT]")
    axes.set_ylabel(observable_label(symbol))
    # Outside: the curves may be anywhere.
    legend_above(figure, [axes])
    return figure
