"""(a) Density of the observable over all data, the training set and the long closed loops of one
network: the one of the shown size and strategy with the smallest Kantorovich metric.
(b) Kantorovich metric and (c) mean logarithmic error against reservoir size, medians and
quartiles over the networks of an ensemble, where there are several sizes. In grey: the same
measures between two random halves of the data, in the median. Open markers, if any: published
values; diamonds on the right edge: the published training set.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from burstcast.base.declared import at, read
from burstcast.figures.parts import errors, frame, looks, medians, style
from burstcast.figures.parts.published import published_beside
from burstcast.figures.registry import figure
from burstcast.statistics.reductions import LongTermStatistics


@figure(section="long_term", position=10, cases="long_term")
def draw(
    *,
    data: Mapping[str, Any] = read("case/statistics_data.nc"),
    training: Mapping[str, Any] = read("case/statistics_training.nc"),
    long_term: Sequence[Mapping[str, Any]] = read("long_term_networks/long_term.nc"),
    percentiles: pd.DataFrame = read("case/tables/statistics_percentiles.csv"),
    threshold: float = read("case/event_threshold.json:event_threshold"),
    symbol: str = at("case.space.observable_symbol"),
    observable_name: str = at("case.space.observable_name"),
    published: pd.DataFrame | None = None,
) -> Figure:
    """Draw the data, the training set and the best network, and the measures of all networks."""
    true, trained = (LongTermStatistics.from_arrays(file).histogram for file in (data, training))
    best = errors.best_of(data, long_term)
    shown = [(true, looks.TRUTH, "True"), (trained, looks.TRAINING, "Train")]
    if best is not None:
        shown.append((best.statistics.histogram, looks.NETWORK, best.label))
    several = errors.several_sizes(percentiles)
    figure = style.new_figure(style.DOUBLE_COLUMN, 4.2 if several else 2.4)
    mosaic: Any = [["density", "density"], ["kantorovich", "mean_log_error"]]
    panels = figure.subplot_mosaic(mosaic if several else mosaic[:1])
    density = panels.pop("density")
    for histogram, look, label in shown:
        density.stairs(histogram.density, true.edges, baseline=None, label=label, **look)
    frame.density_axes(density, threshold, symbol, observable_name)
    density.set_ylim(0.5 * true.density[true.density > 0].min(), 2.5 * true.density.max())
    density.set_xlim(float(true.edges[0]), float(true.edges[-1]))
    if not several:
        style.legend_above(figure, [density])
        return figure
    theirs = published_beside(percentiles, published, "statistics")
    errors.draw(panels, percentiles, theirs)
    below = list(panels.values())
    more = [*medians.spread_handles(below), *medians.published_handles(below)]
    style.legend_above(figure, [density, below[0]], more, columns=4)
    style.letter_panels([density, *below])
    return figure
