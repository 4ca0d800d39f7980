"""The control strategy on the suppressed event: a forecast from time 0 crosses the threshold in
the window after the prediction time, which raises an alarm; the equations are changed over the
shaded interval.
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
    CONTROLLED,
    DOUBLE_COLUMN,
    GREEN,
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
    section="control",
    position=10,
    inputs={"event": "suppressed_event"},
    settings={
        "threshold": "case.event_threshold",
        "prediction_time_lt": "shown.control_prediction_time_lt",
        "window_lt": "control.window_lt",
        "parameters": "case.actuation.parameters",
        "force": "case.actuation.force",
        "symbol": "shown.symbol",
    },
    cases="control_example",
)


def draw(
    *,
    event: Mapping[str, Any],
    threshold: float,
    prediction_time_lt: float,
    window_lt: float,
    parameters: Mapping[str, float],
    force: Any,
    symbol: str,
) -> Figure:
    """Draw the event, the forecast and the parts of the strategy.

    ``parameters`` and ``force`` are what the actuation changes in the equations and adds to them.
    """
    if not event["mark"].size:
        return nothing_to_show("No event was suppressed.")
    changes = [
        f"{'Re' if name == 'reynolds' else name.replace('_', ' ')} = {value:g}"
        for name, value in parameters.items()
    ]
    start, stop = event["actuation_lt"]
    return control_schematic(
        event["time_lt"],
        event["uncontrolled"],
        event["controlled"],
        event["forecast"],
        threshold,
        prediction_time_lt,
        (start, stop),
        window_lt=window_lt,
        symbol=symbol,
        actuation_label=", ".join(changes + ["added force"] * (force is not None)),
    )


@styled
def control_schematic(
    time_lt: FloatArray,
    uncontrolled: FloatArray,
    controlled: FloatArray,
    forecast: FloatArray,
    threshold: float,
    prediction_time_lt: float,
    actuation_lt: tuple[float, float],
    *,
    window_lt: float = 1.0,
    symbol: str = "k",
    actuation_label: str = "Re = 2000",
) -> Figure:
    """Draw one event with and without control, and the parts of the strategy.

    ``time_lt``, ``uncontrolled``, ``controlled``, ``forecast``: Observable, ``(time,)``; the
    forecast that raises the alarm starts at time 0 and is not a number where there is none.
    ``prediction_time_lt``, ``window_lt``: The forecast crosses the threshold in the window that
    begins at the prediction time.
    """
    figure = new_figure(DOUBLE_COLUMN, 2.6)
    axes = figure.subplots()
    top = float(np.nanmax([uncontrolled, controlled, forecast]))
    floor = axis_floor(uncontrolled, controlled, forecast)
    height = top - floor
    window = (prediction_time_lt, prediction_time_lt + window_lt)
    axes.axvspan(*actuation_lt, color=GREEN, alpha=0.13, linewidth=0, zorder=0.4)
    axes.axvspan(*window, facecolor="none", edgecolor=LIGHT_GREY, hatch="//////", linewidth=0)
    for edge in window:
        axes.axvline(edge, **WINDOW)
    for edge in actuation_lt:
        axes.axvline(edge, color=GREEN, linewidth=0.7)
    axes.axvline(0, color=VERMILLION, linewidth=0.9, linestyle=":")
    draw_threshold(axes, threshold, f"${symbol}_e$", at_left=True)
    axes.plot(time_lt, uncontrolled, label="without control", **TRUTH)
    axes.plot(time_lt, forecast, label="network's forecast", **NETWORK)
    axes.plot(time_lt, controlled, label="with control", **CONTROLLED)
    axes.plot(0, uncontrolled[abs(time_lt).argmin()], "o", color=VERMILLION, ms=4.5, zorder=4)
    draw_span(axes, 0, prediction_time_lt, floor + 1.12 * height, "prediction time", VERMILLION)
    draw_span(axes, *window, floor + 1.12 * height, "event forecast: alarm", BLUE)
    draw_span(axes, *actuation_lt, floor + 1.38 * height, f"control: {actuation_label}", GREEN)
    axes.set_ylim(floor, floor + 1.62 * height)
    axes.set_xlim(float(time_lt[0]), float(time_lt[-1]))
    axes.set_xlabel("Time from the forecast [LT]")
    axes.set_ylabel(observable_label(symbol))
    legend_above(figure, [axes])
    return figure
