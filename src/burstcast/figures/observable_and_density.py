"""Typical evolution of the observable (the first kept series that has extreme events; they are
shaded) and its probability density over all kept data. The line is the event threshold.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from burstcast.base.arrays import FloatArray
from burstcast.base.declared import at, read
from burstcast.base.series_lengths import numbers_of
from burstcast.figures.parts import frame, looks, style
from burstcast.figures.registry import figure
from burstcast.statistics.densities import bin_edges, edges_over, histogram


@figure(section="data", position=10, cases="every")
def draw(
    *,
    observable: FloatArray = read("case/ensemble.nc:observable"),
    unit: int = read("case/time_unit.json:steps_per_lyapunov_time"),
    threshold: float = read("case/event_threshold.json:event_threshold"),
    density: Mapping[str, Any] = at("case.density"),
    symbol: str = at("case.space.observable_symbol"),
    observable_name: str = at("case.space.observable_name"),
) -> Figure:
    """Draw the first kept series with an event, and the histogram of all kept series.

    ``observable``: ``(series, time)``. ``density``: Number of ``bins`` of the histogram, and their
    ``range``; None: the range of the data.
    """
    # the first if none has any
    shown = numbers_of(observable[np.argmax((observable >= threshold).any(axis=1))])
    time_lt = np.arange(len(shown)) / unit
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.1)
    evolution, panel = figure.subplots(1, 2, width_ratios=[2.1, 1.0])
    shade = {"color": style.LIGHT_GREY, "linewidth": 0, "zorder": 0.5}
    for first, last in frame.true_runs(shown >= threshold):
        evolution.axvspan(time_lt[first], time_lt[last], **shade)
    evolution.plot(time_lt, shown, **{**looks.TRUTH, "linewidth": 0.8})
    frame.draw_threshold(evolution, threshold, f"${symbol}_e$")
    evolution.set_xlim(time_lt[0], time_lt[-1])
    evolution.set_ylim(frame.axis_limits(threshold, shown))
    evolution.set_xlabel("Time [LT]")
    evolution.set_ylabel(frame.observable_label(symbol, observable_name))

    if density["range"] is None:
        edges = edges_over(numbers_of(observable), density["bins"])
    else:
        low, high = density["range"]
        edges = bin_edges(low, high, density["bins"])
    height = histogram(numbers_of(observable), edges).density
    panel.stairs(height, edges, color=style.BLACK, linewidth=looks.TRUTH["linewidth"])
    beyond = edges[:-1] >= threshold
    panel.stairs(
        height[beyond], edges[-beyond.sum() - 1 :], fill=True, color=style.LIGHT_GREY, zorder=0.5
    )
    frame.density_axes(panel, threshold, symbol, observable_name)
    panel.set_ylim(0.6 * height[height > 0].min(), 2.5 * height.max())
    panel.set_xlim(edges[0], edges[-1])
    style.letter_panels([evolution, panel])
    return figure
