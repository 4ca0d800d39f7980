"""One forecast of the example network with its parts: washout, prediction time, and the window
that is classified.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from burstcast.base.declared import at, read
from burstcast.figures.parts import frame, looks, style
from burstcast.figures.registry import figure


@figure(section="forecasts", position=10, needs_networks=True)
def draw(
    *,
    examples: Mapping[str, Any] = read("example/examples.nc"),
    threshold: float = read("case/event_threshold.json:event_threshold"),
    prediction_time_lt: float = at("shown.example_prediction_time_lt"),
    washout_lt: float = at("washout_lt"),
    window_lt: float = at("classification.window_lt"),
    symbol: str = at("case.space.observable_symbol"),
) -> Figure:
    """Draw the first example, a true positive if there was one, with the names of its parts."""
    if not len(examples["outcome"]):
        return style.nothing_to_show("No event occurred in the test set, and none was predicted.")
    window = (prediction_time_lt, prediction_time_lt + window_lt)
    time_lt, true = examples["example_time_lt"], examples["example_truth"][0]
    curves = [true, examples["example_forecast"][0]]
    floor = frame.axis_floor(*curves)
    room = float(np.nanmax(true)) - floor
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.5)
    axes = figure.subplots()
    frame.draw_window(axes, window, **frame.SHADED)
    axes.axvspan(-washout_lt, 0, linewidth=0, zorder=0.5, **frame.HATCHED)
    axes.axvline(0, color=style.VERMILLION, linewidth=0.9, linestyle=":")
    frame.draw_threshold(axes, threshold, f"${symbol}_e$")
    labels = frame.true_and_forecast(symbol)
    for curve, label, look in zip(curves, labels, (looks.TRUTH, looks.NETWORK), strict=True):
        axes.plot(time_lt, curve, label=label, **look)
    height = floor + 1.18 * room
    question = f"event here?\nwindow, {window_lt:g} LT"
    frame.mark_start(axes, time_lt, true)
    frame.draw_span(
        axes, -washout_lt, 0, height, "washout\n(open loop)", style.GREY, to_the_left=True
    )
    frame.draw_span(
        axes, 0, prediction_time_lt, height, "prediction time (closed loop)", style.VERMILLION
    )
    frame.draw_span(axes, *window, height, question, style.BLUE)
    axes.set_ylim(floor, floor + 1.5 * room)
    axes.set_xlim(float(time_lt[0]), float(time_lt[-1]))
    axes.set_xlabel("Time from the start of the forecast [LT]")
    axes.set_ylabel(frame.observable_label(symbol))
    # Outside: the curves may be anywhere.
    style.legend_above(figure, [axes])
    return figure
