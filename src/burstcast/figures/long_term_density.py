"""Long-term density of the observable, and the errors in it against reservoir size."""

import pandas as pd
from matplotlib.figure import Figure

from burstcast.arrays import FloatArray
from burstcast.figures.parts.percentile_curves import published_handles, require_single_case
from burstcast.figures.parts.statistics_by_size import draw_statistics_by_size
from burstcast.figures.parts.style import (
    DOUBLE_COLUMN,
    NETWORK,
    THRESHOLD,
    TRAINING,
    TRUTH,
    legend_above,
    letter_panels,
    new_figure,
    observable_label,
    styled,
)


@styled
def long_term_density(
    bin_edges: FloatArray,
    true: FloatArray,
    training: FloatArray,
    network: FloatArray | None,
    percentiles: pd.DataFrame,
    intervals: pd.DataFrame,
    threshold: float,
    *,
    network_label: str = "ESN (best)",
    symbol: str = "k",
    name: str = "kinetic energy",
    published: pd.DataFrame | None = None,
) -> Figure:
    """Draw (a) the densities, (b) the Kantorovich metric and (c) the mean logarithmic error.

    Parameters
    ----------
    bin_edges
        ``(bins + 1,)``.
    true, training, network
        Densities, ``(bins,)``; the network is the best one of its size, None if no network has one.
    percentiles
        Of one case: forecaster (``esn``, ``training``, ``floor``), neurons, validation, metric
        (``kantorovich``, ``mean_log_error``), p25, p50, p75.
    intervals
        Of the same case and each network by itself: neurons, validation, metric, low, high.
    threshold
        Event threshold.
    network_label
        Of the network in the legend.
    symbol, name
        Of the observable.
    published
        Published percentiles in the same form, drawn as open markers at the sizes of the table;
        those of the training set as an open marker on the right edge.

    Raises
    ------
    ValueError
        If the table holds several cases.
    """
    require_single_case(percentiles)
    figure = new_figure(DOUBLE_COLUMN, 4.2)
    panels = figure.subplot_mosaic([["density", "density"], ["kantorovich", "mean_log_error"]])
    density = panels["density"]
    for values, style, label in (
        (true, TRUTH, "True"),
        (training, TRAINING, "Train"),
        (network, NETWORK, network_label),
    ):
        if values is None:
            continue
        density.stairs(
            values,
            bin_edges,
            baseline=None,
            label=label,
            color=style["color"],
            linestyle=style["linestyle"],
            linewidth=style["linewidth"],
        )
    density.axvline(threshold, **THRESHOLD)
    density.annotate(
        f"${symbol}_e$",
        (threshold, 1),
        (2.5, -3),
        density.get_xaxis_transform(),
        "offset points",
        ha="left",
        va="top",
        color=THRESHOLD["color"],
    )
    density.set_yscale("log")
    density.set_ylim(0.5 * true[true > 0].min(), 2.5 * true.max())
    density.set_xlim(float(bin_edges[0]), float(bin_edges[-1]))
    density.set_xlabel(observable_label(symbol, name))
    density.set_ylabel("PDF")
    errors = {metric: panels[metric] for metric in ("kantorovich", "mean_log_error")}
    draw_statistics_by_size(errors, percentiles, intervals, published)
    more = published_handles(panels.values())
    legend_above(figure, [density, panels["kantorovich"]], more)
    letter_panels([density, panels["kantorovich"], panels["mean_log_error"]])
    return figure
