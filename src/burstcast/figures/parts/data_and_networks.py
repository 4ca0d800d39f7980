"""Two panels of the data beside networks: one of a curve, one of a number against their size."""

from collections.abc import Callable

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from burstcast.figures.parts.percentile_curves import (
    NEURONS_LABEL,
    draw_percentiles,
    require_single_case,
    select,
    spread_handles,
)
from burstcast.figures.parts.reference_forecasters import draw_references
from burstcast.figures.parts.style import (
    BLUE,
    DOUBLE_COLUMN,
    TRUTH,
    band_handle,
    legend_above,
    letter_panels,
    new_figure,
    ordered_validations,
    validation_style,
)


def two_panels(
    draw_left: Callable[[Axes], None],
    draw_right: Callable[[Axes], None],
    *percentiles: pd.DataFrame,
) -> Figure:
    """Draw two panels with a common legend."""
    for table in percentiles:
        require_single_case(table)
    figure = new_figure(DOUBLE_COLUMN, 2.6)
    panels = figure.subplots(1, 2)
    draw_left(panels[0])
    draw_right(panels[1])
    more = [band_handle("interval of the data"), *spread_handles(panels, color=BLUE)]
    legend_above(figure, list(panels), more)
    letter_panels(list(panels))
    return figure


def draw_by_size(
    axes: Axes, data: "pd.Series[float]", percentiles: pd.DataFrame, metric: str
) -> None:
    """Draw a metric of networks against their size, beside its value and interval of the data.

    ``data``: The metric, and its interval, ``<metric>_low`` and ``<metric>_high``. ``percentiles``:
    Percentiles of the networks of all sizes, with others to compare with.
    """
    ends = data[f"{metric}_low"], data[f"{metric}_high"]
    axes.axhspan(*ends, color=TRUTH["color"], alpha=0.15, linewidth=0)
    axes.axhline(data[metric], **TRUTH)
    networks = select(percentiles, forecaster="esn", metric=metric)
    for validation in ordered_validations(networks["validation"].dropna()):
        rows = select(networks, validation=validation)
        style = validation_style(validation)
        draw_percentiles(axes, rows, "neurons", style, label=f"ESN, {validation}")
    draw_references(axes, percentiles, metric, "neurons", leave_out=["data"])
    axes.set_xticks(sorted(networks["neurons"].dropna().unique()))
    axes.margins(x=0.1)
    axes.set_xlabel(NEURONS_LABEL)
