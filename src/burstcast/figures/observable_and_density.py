"""A typical evolution of the observable, and its probability density."""

from matplotlib.figure import Figure

from burstcast.arrays import FloatArray
from burstcast.figures.parts.style import (
    DOUBLE_COLUMN,
    LIGHT_GREY,
    THRESHOLD,
    TRUTH,
    draw_threshold,
    letter_panels,
    new_figure,
    observable_label,
    styled,
    true_runs,
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

    Parameters
    ----------
    time_lt, observable
        Of one series, ``(time,)``; time in Lyapunov times.
    bin_edges, density
        Of the density over all data, ``(bins + 1,)`` and ``(bins,)``.
    threshold
        The observable at which an event begins.
    symbol, name
        Of the observable; the symbol in TeX without dollars.
    """
    figure = new_figure(DOUBLE_COLUMN, 2.1)
    evolution, histogram = figure.subplots(1, 2, width_ratios=[2.1, 1.0])
    for first, last in true_runs(observable >= threshold):
        evolution.axvspan(time_lt[first], time_lt[last], color=LIGHT_GREY, linewidth=0, zorder=0.5)
    evolution.plot(time_lt, observable, **{**TRUTH, "linewidth": 0.8})
    draw_threshold(evolution, threshold, f"${symbol}_e$")
    evolution.set_xlim(time_lt[0], time_lt[-1])
    evolution.set_ylim(bottom=min(0.0, float(observable.min())))
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
    histogram.set_ylabel("PDF")
    letter_panels([evolution, histogram])
    return figure
