"""(a) Density of the observable over all data, the training set and the long closed loops of one
network: the one of the shown size and strategy with the smallest Kantorovich metric.
(b) Kantorovich metric and (c) mean logarithmic error against reservoir size, medians and
quartiles over the networks of an ensemble. Thin bars: the bootstrap interval of one
network over its closed loops, in the median. In grey: the same measures between two random halves
of the data, in the median. Open markers, if any: published values; diamonds on the right edge: the
published training set.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from burstcast.arrays import FloatArray
from burstcast.figures.parts.best_network import best_of
from burstcast.figures.parts.percentile_curves import (
    published_handles,
    require_single_case,
    spread_handles,
)
from burstcast.figures.parts.statistics_by_size import draw_statistics_by_size
from burstcast.figures.parts.style import (
    DOUBLE_COLUMN,
    NETWORK,
    THRESHOLD,
    TRAINING,
    TRUTH,
    density_label,
    legend_above,
    letter_panels,
    new_figure,
    observable_label,
    styled,
)
from burstcast.figures.registry import Declaration
from burstcast.statistics.reductions import LongTermStatistics
from burstcast.tables.published import published_beside

FIGURE = Declaration(
    section="long_term",
    position=10,
    inputs={
        "data": "case/statistics_data.nc",
        "training": "case/statistics_training.nc",
        "long_term": "long_term_networks/long_term.nc",
        "percentiles": "case/tables/statistics_percentiles.csv",
        "intervals": "case/tables/statistics_intervals.csv",
    },
    settings={
        "threshold": "case.event_threshold",
        "symbol": "shown.symbol",
        "observable_name": "shown.observable_name",
    },
    cases="long_term",
    published=True,
)


def draw(
    *,
    data: Mapping[str, Any],
    training: Mapping[str, Any],
    long_term: Sequence[Mapping[str, Any]],
    percentiles: pd.DataFrame,
    intervals: pd.DataFrame,
    threshold: float,
    symbol: str,
    observable_name: str,
    published: pd.DataFrame | None = None,
) -> Figure:
    """Draw the data, the training set and the best network, and the measures of all networks."""
    true = LongTermStatistics.from_arrays(data).histogram
    best = best_of(data, long_term)
    return long_term_density(
        true.edges,
        true.density,
        LongTermStatistics.from_arrays(training).histogram.density,
        None if best is None else best.statistics.histogram.density,
        percentiles,
        intervals,
        threshold,
        network_label="" if best is None else best.label,
        symbol=symbol,
        name=observable_name,
        published=published_beside(percentiles, published, "statistics"),
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

    ``bin_edges``: ``(bins + 1,)``. ``true``, ``training``, ``network``: Densities, ``(bins,)``; the
    network is the best one of its size, None if no network has one. ``percentiles``: Percentiles of
    one case: forecaster (``esn``, ``training``, ``floor``), neurons, validation, metric
    (``kantorovich``, ``mean_log_error``), p25, p50, p75.
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
    density.set_ylabel(density_label(symbol))
    errors = {metric: panels[metric] for metric in ("kantorovich", "mean_log_error")}
    draw_statistics_by_size(errors, percentiles, intervals, published)
    more = [*spread_handles(panels.values()), *published_handles(panels.values())]
    legend_above(figure, [density, panels["kantorovich"]], more, columns=4)
    letter_panels([density, panels["kantorovich"], panels["mean_log_error"]])
    return figure
