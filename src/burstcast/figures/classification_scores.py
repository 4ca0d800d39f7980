"""Precision, recall and F-score: medians (lines) and quartiles (bands) over the networks of an
ensemble. In grey: forecasters to compare with.
"""

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from burstcast.base.declared import at, read
from burstcast.figures.parts import looks, medians, style
from burstcast.figures.parts.published import published_beside
from burstcast.figures.registry import figure

_METRICS = ("precision", "recall", "f_score")
_TIME = "prediction_time_lt"


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

    The first column holds the size fixed; the second, where there are three sizes, the prediction
    time; the last, where there are two, shows up to four sizes for one strategy. Where the table
    has no such size, time or strategy, the nearest or the last is shown.
    """
    theirs = published_beside(percentiles, published, "classification")
    networks = percentiles[percentiles["forecaster"] == "esn"]
    neurons = medians.nearest_value(networks, "neurons", fixed_neurons)
    time = medians.nearest_value(networks, _TIME, fixed_prediction_time_lt)
    validations = looks.ordered_validations(networks["validation"].dropna())
    sizes = np.unique(networks["neurons"].dropna().to_numpy(dtype=np.float64))
    if sizes_validation not in validations:
        sizes_validation = validations[-1]
    theirs = percentiles.iloc[:0] if theirs is None else theirs[theirs["neurons"].isin(sizes)]

    columns = {"size": f"{neurons:g} neurons"}
    if len(sizes) > 2:
        columns["time"] = f"PT = {time:g} LT"
    if len(sizes) > 1:
        columns["strategy"] = sizes_validation
    figure = style.new_figure(style.DOUBLE_COLUMN * (1.0 if len(columns) > 1 else 0.5), 5.6)
    grid = figure.subplots(3, len(columns), sharex="col", sharey=True, squeeze=False)
    panels = dict(zip(columns, grid.T, strict=True))
    for row, metric in enumerate(_METRICS):
        first = panels["size"][row]
        medians.draw_references(first, percentiles, metric, _TIME, neurons=neurons)
        first.set_ylabel(medians.LABELS[metric])
        for validation in validations:
            look = looks.validation(validation)
            chosen = {"metric": metric, "validation": validation}
            at_size, at_time = {**chosen, "neurons": neurons}, {**chosen, _TIME: time}
            _draw_curve(first, networks, theirs, at_size, _TIME, look, validation)
            if "time" in columns:
                panel = panels["time"][row]
                _draw_curve(panel, networks, theirs, at_time, "neurons", look, validation)
        if "strategy" in columns:
            some = looks.few_of(sizes)
            for size, look in zip(some, looks.sequence(len(some)), strict=True):
                at_size = {"metric": metric, "validation": sizes_validation, "neurons": float(size)}
                panel = panels["strategy"][row]
                _draw_curve(panel, networks, theirs, at_size, _TIME, look, f"{size:g}")
    lowest = min((panel.dataLim.y0 for panel in grid.flat if panel.has_data()), default=0.0)
    grid[0, 0].set_ylim(max(0.0, np.floor(10 * lowest) / 10), 1.02)
    more = [*medians.spread_handles(grid.flat), *medians.published_handles(grid.flat)]
    style.legend_above(figure, panels["size"], more, columns=4 if len(columns) > 1 else 2)
    medians.say_where_empty(grid.flat)
    for column, (top, _, bottom) in panels.items():
        top.set_title(columns[column], loc="center")
        bottom.set_xlabel(medians.NEURONS if column == "time" else medians.PREDICTION_TIME)
        if column == "time":
            top.set_xticks(sizes, [f"{size:g}" for size in sizes])
            top.margins(x=0.08)
            medians.thin_size_labels(bottom, sizes)
        else:
            top.xaxis.set_major_locator(MultipleLocator(1))
    if "strategy" in columns and panels["strategy"][2].has_data():
        panels["strategy"][2].legend(title="neurons", loc="best", ncols=2 if len(sizes) > 3 else 1)
    style.letter_panels(list(grid.flat))
    return figure


def _draw_curve(
    axes: Axes,
    networks: pd.DataFrame,
    theirs: pd.DataFrame,
    chosen: Mapping[str, object],
    x: str,
    look: looks.MarkerStyle,
    label: str,
) -> None:
    """Draw the chosen rows of our networks, and of the published ones."""
    medians.draw(axes, medians.select(networks, **chosen), x, look, label=label)
    medians.draw_published(axes, medians.select(theirs, **chosen), x, look)
