"""Precision, recall and F-score: medians (lines) and quartiles (bands) over the networks of an
ensemble. In grey: forecasters to compare with.
"""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from burstcast.figures.parts.percentile_curves import (
    METRIC_LABELS,
    NEURONS_LABEL,
    PREDICTION_TIME_LABEL,
    draw_percentiles,
    draw_published,
    nearest_value,
    published_handles,
    require_single_case,
    say_where_empty,
    select,
    spread_handles,
)
from burstcast.figures.parts.reference_forecasters import draw_references
from burstcast.figures.parts.style import (
    DOUBLE_COLUMN,
    letter_panels,
    new_figure,
    ordered_validations,
    sequence_styles,
    styled,
    validation_style,
)
from burstcast.figures.registry import Declaration
from burstcast.tables.published import published_beside

FIGURE = Declaration(
    section="forecasts",
    position=30,
    inputs={"percentiles": "case/tables/classification_percentiles.csv"},
    settings={
        "fixed_neurons": "figures.fixed_neurons",
        "fixed_prediction_time_lt": "figures.fixed_prediction_time_lt",
        "sizes_validation": "shown.validation",
    },
    cases="networks",
    published=True,
)

METRICS = ("precision", "recall", "f_score")


def draw(
    *,
    percentiles: pd.DataFrame,
    fixed_neurons: int,
    fixed_prediction_time_lt: float,
    sizes_validation: str,
    published: pd.DataFrame | None = None,
) -> Figure:
    """Draw the scores of one case."""
    return classification_scores(
        percentiles,
        fixed_neurons,
        fixed_prediction_time_lt,
        sizes_validation=sizes_validation,
        published=published_beside(percentiles, published, "classification"),
    )


@styled
def classification_scores(
    percentiles: pd.DataFrame,
    fixed_neurons: float,
    fixed_prediction_time_lt: float,
    *,
    sizes_validation: str = "RV",
    published: pd.DataFrame | None = None,
) -> Figure:
    """Draw three rows of panels (precision, recall, F-score) in up to three columns.

    The first column holds the size fixed, the second the prediction time; the third shows all
    sizes for one strategy. With a single size the other columns would repeat the first one and are
    left out.

    ``percentiles``: Percentiles of one case: forecaster, neurons, validation, prediction_time_lt,
    metric, p25, p50, p75. Forecasters other than ``esn`` (the equations) are drawn as grey
    references in the first column. ``fixed_neurons``, ``fixed_prediction_time_lt``: What the first
    and the second column hold fixed. Where the table has no such value, the nearest one is shown;
    the heads of the columns name it. ``sizes_validation``: Strategy of the third column, if the
    table has it. ``published``: Published percentiles in the same form, drawn as open markers at
    the sizes of the table.
    """
    require_single_case(percentiles)
    networks = percentiles[percentiles["forecaster"] == "esn"]
    neurons = nearest_value(networks, "neurons", fixed_neurons)
    prediction_time = nearest_value(networks, "prediction_time_lt", fixed_prediction_time_lt)
    validations = ordered_validations(networks["validation"].dropna())
    sizes = np.unique(networks["neurons"].dropna().to_numpy(dtype=np.float64))
    if sizes_validation not in validations:
        sizes_validation = validations[-1]
    if published is None:
        published = percentiles.iloc[:0]
    published = published[published["neurons"].isin(sizes)]

    columns = 3 if len(sizes) > 1 else 1
    figure = new_figure(DOUBLE_COLUMN if columns > 1 else DOUBLE_COLUMN / 2, 5.6)
    panels: np.ndarray[Any, Any] = figure.subplots(
        3, columns, sharex="col", sharey=True, squeeze=False
    )
    for row, metric in enumerate(METRICS):
        by_time: Axes = panels[row, 0]
        draw_references(by_time, percentiles, metric, "prediction_time_lt", neurons=neurons)
        for validation in validations:
            style = validation_style(validation)
            chosen: dict[str, object] = {"validation": validation, "metric": metric}
            at_size = {**chosen, "neurons": neurons}
            draw_percentiles(
                by_time, select(networks, **at_size), "prediction_time_lt", style, label=validation
            )
            draw_published(by_time, select(published, **at_size), "prediction_time_lt", style)
            if columns > 1:
                at_time = {**chosen, "prediction_time_lt": prediction_time}
                by_size: Axes = panels[row, 1]
                draw_percentiles(
                    by_size, select(networks, **at_time), "neurons", style, label=validation
                )
                draw_published(by_size, select(published, **at_time), "neurons", style)
        if columns > 1:
            for size, style in zip(sizes, sequence_styles(len(sizes)), strict=True):
                chosen = {
                    "validation": sizes_validation,
                    "metric": metric,
                    "neurons": float(size),
                }
                of_size: Axes = panels[row, 2]
                draw_percentiles(
                    of_size,
                    select(networks, **chosen),
                    "prediction_time_lt",
                    style,
                    label=f"{size:g}",
                )
                draw_published(of_size, select(published, **chosen), "prediction_time_lt", style)
        by_time.set_ylabel(METRIC_LABELS[metric])
    _finish(panels, sizes, neurons, prediction_time, sizes_validation)
    return figure


def _finish(
    panels: np.ndarray[Any, Any],
    sizes: np.ndarray[Any, Any],
    neurons: float,
    prediction_time: float,
    sizes_validation: str,
) -> None:
    """Set limits, ticks, heads and legends."""
    lowest = min((panel.dataLim.y0 for panel in panels.flat if panel.has_data()), default=0.0)
    panels[0, 0].set_ylim(max(0.0, np.floor(10 * lowest) / 10), 1.02)
    heads = [f"{neurons:g} neurons", f"PT = {prediction_time:g} LT", f"{sizes_validation}"]
    # a metric that is undefined everywhere leaves its panel without curves
    drawn = [panel.get_legend_handles_labels() for panel in panels[:, 0]]
    entries = {label: handle for panel in drawn for handle, label in zip(*panel, strict=True)}
    handles = [
        *entries.values(),
        *spread_handles(panels.flat),
        *published_handles(panels.flat),
    ]
    if len(handles) > 3:  # more would hide the curves
        columns = min(len(handles), 4) if panels.shape[1] > 1 else 2
        panels[0, 0].get_figure().legend(handles=handles, loc="outside upper center", ncols=columns)
    elif handles:
        panels[2, 0].legend(handles=handles, loc="best")
    say_where_empty(panels.flat)
    for column in range(panels.shape[1]):
        panels[2, column].set_xlabel(NEURONS_LABEL if column == 1 else PREDICTION_TIME_LABEL)
        panels[0, column].set_title(heads[column], loc="center")
        if column != 1:
            panels[0, column].xaxis.set_major_locator(MultipleLocator(1))
    if panels.shape[1] > 1:
        panels[0, 1].set_xticks(sizes)
        panels[0, 1].margins(x=0.08)
        if len(sizes) > 4:
            panels[0, 1].set_xticks(sizes, [f"{size:g}" for size in sizes], rotation=0)
            for index, label in enumerate(panels[2, 1].get_xticklabels()):
                label.set_visible(index % 2 == 1)
        if panels[2, 2].has_data():
            panels[2, 2].legend(title="neurons", loc="best", ncols=2 if len(sizes) > 3 else 1)
    letter_panels(list(panels.flat))
