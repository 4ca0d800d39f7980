"""The control strategy on the suppressed event: a forecast from time 0 crosses the threshold in
the window after the prediction time, which raises an alarm; the equations are changed over the
shaded interval.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from burstcast.base.declared import at, read
from burstcast.figures.parts import frame, looks, style
from burstcast.figures.registry import figure


@figure(section="control", position=10, cases="control_example")
def draw(
    *,
    event: Mapping[str, Any] = read("suppressed_event"),
    threshold: float = read("case/event_threshold.json:event_threshold"),
    prediction_time_lt: float = at("shown.example_run.prediction_time_lt"),
    window_lt: float = at("control.window_lt"),
    parameters: Mapping[str, float] = at("case.actuation.parameters"),
    force: Any = at("case.actuation.force"),
    symbol: str = at("case.space.observable_symbol"),
) -> Figure:
    """Draw one event with and without control, the forecast and the parts of the strategy.

    ``parameters`` and ``force`` are what the actuation changes in the equations and adds to them.
    """
    if not event["mark"].size:
        return style.nothing_to_show("No event was suppressed.")
    shown = {
        "uncontrolled": ("without control", looks.TRUTH),
        "forecast": ("network's forecast", looks.NETWORK),
        "controlled": ("with control", looks.CONTROLLED),
    }
    curves = [event[name] for name in shown]
    floor = frame.axis_floor(*curves)
    height = float(np.nanmax(curves)) - floor
    changes = [
        f"{'Re' if name == 'reynolds' else name.replace('_', ' ')} = {value:g}"
        for name, value in parameters.items()
    ]
    changes += ["added force"] * (force is not None)
    time_lt, (start, stop) = event["time_lt"], event["actuation_lt"]
    window = (prediction_time_lt, prediction_time_lt + window_lt)
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.6)
    axes = figure.subplots()
    axes.axvspan(start, stop, color=style.GREEN, alpha=0.13, linewidth=0, zorder=0.4)
    frame.draw_window(axes, window, **frame.HATCHED)
    for edge in (start, stop):
        axes.axvline(edge, color=style.GREEN, linewidth=0.7)
    axes.axvline(0, color=style.VERMILLION, linewidth=0.9, linestyle=":")
    frame.draw_threshold(axes, threshold, f"${symbol}_e$", at_left=True)
    for name, (label, look) in shown.items():
        axes.plot(time_lt, event[name], label=label, **look)
    frame.mark_start(axes, time_lt, event["uncontrolled"])
    for (begin, end), share, label, color in (
        ((0, prediction_time_lt), 1.12, "prediction time", style.VERMILLION),
        (window, 1.12, "event forecast: alarm", style.BLUE),
        ((start, stop), 1.38, f"control: {', '.join(changes)}", style.GREEN),
    ):
        frame.draw_span(axes, begin, end, floor + share * height, label, color)
    axes.set_ylim(floor, floor + 1.62 * height)
    axes.set_xlim(float(time_lt[0]), float(time_lt[-1]))
    axes.set_xlabel("Time from the forecast [LT]")
    axes.set_ylabel(frame.observable_label(symbol))
    style.legend_above(figure, [axes])
    return figure
