"""Forecasts of the example network with each outcome. Of all forecasts with an outcome, the one
is shown whose burst has the median height; misses and false alarms that are more than an error of
timing come first.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from burstcast.base.declared import at, read
from burstcast.figures.parts import frame, looks, style
from burstcast.figures.registry import figure
from burstcast.forecasts.examples import OUTCOMES


@figure(section="forecasts", position=20, needs_networks=True)
def draw(
    *,
    examples: Mapping[str, Any] = read("example/examples.nc"),
    threshold: float = read("case/event_threshold.json:event_threshold"),
    prediction_time_lt: float = at("shown.example_prediction_time_lt"),
    window_lt: float = at("classification.window_lt"),
    symbol: str = at("case.space.observable_symbol"),
) -> Figure:
    """Draw one panel for each outcome that occurred, with the window that is classified.

    ``examples``: See `burstcast.forecasts.examples`; not a number where a curve has not begun.
    """
    count = len(examples["outcome"])
    if not count:
        return style.nothing_to_show("No event occurred in the test set, and none was predicted.")
    figure = style.new_figure(style.DOUBLE_COLUMN * (1.0 if count > 1 else 0.5), 2.0)
    panels = figure.subplots(1, count, sharey=True, squeeze=False)[0]
    window = (prediction_time_lt, prediction_time_lt + window_lt)
    time_lt = examples["example_time_lt"]
    curves = examples["example_truth"], examples["example_forecast"]
    labels = frame.true_and_forecast(symbol)
    for index, panel in enumerate(panels):
        frame.draw_window(panel, window, **frame.SHADED)
        frame.draw_threshold(panel, threshold, f"${symbol}_e$", at_left=True)
        for curve, label, look in zip(curves, labels, (looks.TRUTH, looks.NETWORK), strict=True):
            panel.plot(time_lt, curve[index], label=label, **look)
        panel.set_xlim(time_lt[0], time_lt[-1])
        panel.set_xlabel("Time [LT]")
        outcome = OUTCOMES[examples["outcome"][index]]
        panel.set_title(f"({chr(ord('a') + index)}) {outcome}", loc="left")
    panels[0].set_ylim(frame.axis_limits(threshold, np.array(curves)))
    panels[0].set_ylabel(frame.observable_label(symbol))
    style.legend_above(figure, panels)
    return figure
