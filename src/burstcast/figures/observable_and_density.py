"""Typical evolution of the observable (the first kept series that has extreme events; they are
shaded) and its probability density over all kept data. The line is the event threshold.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from burstcast.arrays import FloatArray
from burstcast.figures.parts.observable_axis import axis_limits
from burstcast.figures.parts.style import (
    DOUBLE_COLUMN,
    LIGHT_GREY,
    THRESHOLD,
    TRUTH,
    density_label,
    draw_threshold,
    letter_panels,
    new_figure,
    observable_label,
    styled,
    true_runs,
)
from burstcast.figures.parts.time_axis import samples_per_lyapunov_time
from burstcast.figures.registry import Declaration
from burstcast.statistics.densities import bin_edges, edges_over, histogram

FIGURE = Declaration(
    section="data",
    position=10,
    inputs={"observable": "case/ensemble.nc:observable", "exponents": "time_unit"},
    settings={
        "time_step": "case.ensemble.time_step",
        "sampling_stride": "case.ensemble.sampling_stride",
        "published_exponent": "case.lyapunov.published_exponent",
        "threshold": "case.event_threshold",
        "density": "case.density",
        "symbol": "shown.symbol",
        "observable_name": "shown.observable_name",
    },
    cases="every",
)


def draw(
    *,
    observable: FloatArray,
    exponents: Mapping[str, Any] | None,
    time_step: float,
    sampling_stride: int,
    published_exponent: float,
    threshold: float,
    density: Mapping[str, Any],
    symbol: str,
    observable_name: str,
) -> Figure:
    """Draw the first kept series with an event, and the histogram of all kept series.

    ``observable``: Observable of all series, ``(series, time)``. ``density``: Number of ``bins`` of
    the histogram, and their ``range``; None: the range of the data.
    """
    shown = observable[np.argmax(observable.max(axis=1) >= threshold)]  # the first if none has any
    unit = samples_per_lyapunov_time(exponents, published_exponent, time_step, sampling_stride)
    if density["range"] is None:
        edges = edges_over(observable, density["bins"])
    else:
        low, high = density["range"]
        edges = bin_edges(low, high, density["bins"])
    counts = histogram(observable, edges)
    return observable_and_density(
        np.arange(observable.shape[1]) / unit,
        shown,
        counts.edges,
        counts.density,
        threshold,
        symbol=symbol,
        name=observable_name,
    )


@styled
def observable_and_density(
    time_lt: FloatArray,
    observable: FloatArray,
    bin_edges: FloatArray,
    density: FloatArray,
    threshold: float,
    *,
    symbol: str = "k",
    name: str = "kinetic energy",
) -> Figure:
    """Draw (a) the observable over time with its events shaded and (b) its density.

    ``time_lt``, ``observable``: Time and observable of one series, ``(time,)``; time in Lyapunov
    times. ``bin_edges``, ``density``: Edges of the bins and density over all data, ``(bins + 1,)``
    and ``(bins,)``. ``symbol``, ``name``: Symbol and name of the observable; the symbol in TeX
    without dollars.
    """
    figure = new_figure(DOUBLE_COLUMN, 2.1)
    evolution, histogram = figure.subplots(1, 2, width_ratios=[2.1, 1.0])
    for first, last in true_runs(observable >= threshold):
        evolution.axvspan(time_lt[first], time_lt[last], color=LIGHT_GREY, linewidth=0, zorder=0.5)
    evolution.plot(time_lt, observable, **{**TRUTH, "linewidth": 0.8})
    draw_threshold(evolution, threshold, f"${symbol}_e$")
    evolution.set_xlim(time_lt[0], time_lt[-1])
    evolution.set_ylim(axis_limits(threshold, observable))
    evolution.set_xlabel("Time [LT]")
    evolution.set_ylabel(observable_label(symbol, name))

    filled = density > 0
    histogram.stairs(density, bin_edges, color=TRUTH["color"], linewidth=TRUTH["linewidth"])
    beyond = bin_edges[:-1] >= threshold
    histogram.stairs(
        density[beyond], bin_edges[-beyond.sum() - 1 :], fill=True, color=LIGHT_GREY, zorder=0.5
    )
    histogram.axvline(threshold, **THRESHOLD)
    histogram.annotate(
        f"${symbol}_e$",
        (threshold, 1),
        (2.5, -3),
        histogram.get_xaxis_transform(),
        "offset points",
        ha="left",
        va="top",
        color=THRESHOLD["color"],
    )
    histogram.set_yscale("log")
    histogram.set_ylim(0.6 * density[filled].min(), 2.5 * density.max())
    histogram.set_xlim(bin_edges[0], bin_edges[-1])
    histogram.set_xlabel(observable_label(symbol, name))
    histogram.set_ylabel(density_label(symbol))
    letter_panels([evolution, histogram])
    return figure
