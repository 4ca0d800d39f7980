"""Mean prediction horizon of extreme events against reservoir size: medians (lines) and quartiles
(bands) over the networks of an ensemble. Thin bars: the bootstrap interval of one network's mean
over the events, in the median. In grey: forecasters to compare with.
"""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from burstcast.figures.parts.percentile_curves import (
    METRIC_LABELS,
    NEURONS_LABEL,
    draw_percentiles,
    draw_published,
    draw_single_intervals,
    published_handles,
    require_single_case,
    say_where_empty,
    select,
    spread_handles,
)
from burstcast.figures.parts.reference_forecasters import draw_references
from burstcast.figures.parts.style import (
    SINGLE_COLUMN,
    new_figure,
    ordered_validations,
    styled,
    validation_style,
)
from burstcast.figures.registry import Declaration
from burstcast.tables.published import published_beside

FIGURE = Declaration(
    section="horizon",
    position=30,
    inputs={
        "percentiles": "case/tables/horizon_percentiles.csv",
        "intervals": "case/tables/horizon_intervals.csv",
    },
    cases="several_sizes",
    published=True,
)


def draw(
    *,
    percentiles: pd.DataFrame,
    intervals: pd.DataFrame,
    published: pd.DataFrame | None = None,
) -> Figure:
    """Draw the horizons of one case."""
    beside = published_beside(percentiles, published, "horizon")
    return horizon_by_size(percentiles, intervals, published=beside)


@styled
def horizon_by_size(
    percentiles: pd.DataFrame,
    intervals: pd.DataFrame,
    *,
    published: pd.DataFrame | None = None,
) -> Figure:
    """Draw the quartiles over networks of the mean PH_ee, one curve per validation strategy.

    ``percentiles``: Percentiles of one case: forecaster, neurons, validation, metric
    (``mean_horizon_lt``), p25, p50, p75. ``intervals``: Intervals of the same case and each
    forecaster by itself: forecaster, neurons, validation, metric, low, high. ``published``:
    Published percentiles in the same form, drawn as open markers at the sizes of the table.
    """
    require_single_case(percentiles)
    networks = percentiles[percentiles["forecaster"] == "esn"]
    sizes = np.unique(networks["neurons"].dropna().to_numpy(dtype=np.float64))
    if published is not None:
        published = published[published["neurons"].isin(sizes)]
    many = percentiles["forecaster"].nunique() > 4
    figure = new_figure(SINGLE_COLUMN, 3.2 if many else 2.8)
    axes = figure.subplots()
    # a perfect forecaster reaches the longest lead time of the search
    draw_references(axes, percentiles, "mean_horizon_lt", "neurons", leave_out=["equations"])
    references = len(axes.get_legend_handles_labels()[0])
    for validation in ordered_validations(networks["validation"].dropna()):
        style = validation_style(validation)
        chosen = {"validation": validation, "metric": "mean_horizon_lt"}
        draw_percentiles(axes, select(networks, **chosen), "neurons", style, label=validation)
        draw_single_intervals(axes, intervals, "mean_horizon_lt", validation, style)
        if published is not None:
            draw_published(axes, select(published, **chosen), "neurons", style)
    handles, _ = axes.get_legend_handles_labels()
    handles += [*spread_handles([axes]), *published_handles([axes])]
    # references, whose names are long, have the first column of the legend
    handles += [Line2D([], [], linestyle="", label=" ")] * (2 * references - len(handles))
    axes.set_xticks(sizes)
    axes.margins(x=0.06)
    axes.set_xlabel(NEURONS_LABEL)
    axes.set_ylabel(METRIC_LABELS["mean_horizon_lt"])
    if handles:  # among references at any height there is no room for them
        figure.legend(handles=handles, loc="outside upper center", ncols=2, columnspacing=1.0)
    say_where_empty([axes])
    return figure
