"""Precision, recall and F-score: medians (lines) and quartiles (bands) over the networks of an
ensemble. In grey: forecasters to compare with.
"""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from burstcast.base.declared import at, read
from burstcast.figures.parts import looks, medians, style
from burstcast.figures.parts.published import published_beside
from burstcast.figures.registry import figure

_METRICS = ("precision", "recall", "f_score")


@figure(section="forecasts", position=30, cases="networks")
def draw(
    *,
    percentiles: pd.DataFrame = read("case/tables/classification_percentiles.csv"),
    fixed_neurons: float = at("figures.fixed_neurons"),
    fixed_prediction_time_lt: float = at("shown.fixed_prediction_time_lt"),
    sizes_validation: str = at("shown.example.name.validation"),
    published: pd.DataFrame | None = None,
) -> Figure:
    """Draw three rows of panels (precision, recall, F-score) in up to three columns.

    The first column holds the size fixed, the second the prediction time; the third shows all
    sizes for one strategy. With a single size the other columns would repeat the first one and are
    left out. Where the table has no such size, time or strategy, the nearest or the last is shown.
    """
    theirs = published_beside(percentiles, published, "classification")
    networks = percentiles[percentiles["forecaster"] == "esn"]
    neurons = medians.nearest_value(networks, "neurons", fixed_neurons)
    time = medians.nearest_value(networks, "prediction_time_lt", fixed_prediction_time_lt)
    validations = looks.ordered_validations(networks["validation"].dropna())
    sizes = np.unique(networks["neurons"].dropna().to_numpy(dtype=np.float64))
    if sizes_validation not in validations:
        sizes_validation = validations[-1]
    theirs = percentiles.iloc[:0] if theirs is None else theirs[theirs["neurons"].isin(sizes)]

    columns = 3 if len(sizes) > 1 else 1
    figure = style.new_figure(style.DOUBLE_COLUMN * (1.0 if columns > 1 else 0.5), 5.6)
    panels = figure.subplots(3, columns, sharex="col", sharey=True, squeeze=False)
    for metric, row in zip(_METRICS, panels, strict=True):
        medians.draw_references(row[0], percentiles, metric, "prediction_time_lt", neurons=neurons)
        curves: list[tuple[int, str, Any, str, dict[str, object]]] = []
        for validation in validations:
            look, own = looks.validation(validation), {"validation": validation}
            curves.append((0, "prediction_time_lt", look, validation, {**own, "neurons": neurons}))
            curves.append((1, "neurons", look, validation, {**own, "prediction_time_lt": time}))
        for size, look in zip(sizes, looks.sequence(len(sizes)), strict=True):
            chosen = {"validation": sizes_validation, "neurons": float(size)}
            curves.append((2, "prediction_time_lt", look, f"{size:g}", chosen))
        for column, x, look, label, chosen in curves:
            if column < columns:
                rows, others = (
                    medians.select(table, metric=metric, **chosen) for table in (networks, theirs)
                )
                medians.draw(row[column], rows, x, look, label=label)
                medians.draw_published(row[column], others, x, look)
        row[0].set_ylabel(medians.LABELS[metric])
    heads = (f"{neurons:g} neurons", f"PT = {time:g} LT", sizes_validation)
    _finish(figure, panels, sizes, heads)
    return figure


def _finish(
    figure: Figure, panels: np.ndarray[Any, Any], sizes: np.ndarray[Any, Any], heads: Any
) -> None:
    """Set limits, ticks, heads and legends."""
    lowest = min((panel.dataLim.y0 for panel in panels.flat if panel.has_data()), default=0.0)
    panels[0, 0].set_ylim(max(0.0, np.floor(10 * lowest) / 10), 1.02)
    # a metric that is undefined everywhere leaves its panel without curves
    drawn = [panel.get_legend_handles_labels() for panel in panels[:, 0]]
    entries = {label: handle for panel in drawn for handle, label in zip(*panel, strict=True)}
    handles = [
        *entries.values(),
        *medians.spread_handles(panels.flat),
        *medians.published_handles(panels.flat),
    ]
    if len(handles) > 3:  # more would hide the curves
        columns = min(len(handles), 4) if panels.shape[1] > 1 else 2
        figure.legend(handles=handles, loc="outside upper center", ncols=columns)
    elif handles:
        panels[2, 0].legend(handles=handles, loc="best")
    medians.say_where_empty(panels.flat)
    for column, (top, bottom) in enumerate(zip(panels[0], panels[2], strict=True)):
        bottom.set_xlabel(medians.NEURONS if column == 1 else medians.PREDICTION_TIME)
        top.set_title(heads[column], loc="center")
        if column != 1:
            top.xaxis.set_major_locator(MultipleLocator(1))
    if panels.shape[1] > 1:
        panels[0, 1].set_xticks(sizes)
        panels[0, 1].margins(x=0.08)
        if len(sizes) > 4:
            panels[0, 1].set_xticks(sizes, [f"{size:g}" for size in sizes], rotation=0)
            medians.thin_size_labels(panels[2, 1], sizes)
        if panels[2, 2].has_data():
            panels[2, 2].legend(title="neurons", loc="best", ncols=2 if len(sizes) > 3 else 1)
    style.letter_panels(list(panels.flat))
