"""Precision, recall and F-score: medians (lines) and quartiles (bands) over the networks of an
ensemble, beside forecasters to compare with.
"""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from burstcast.base.declared import at, read
from burstcast.figures.parts import looks, medians, style
from burstcast.figures.parts.published import published_beside
from burstcast.figures.registry import figure

_METRICS = ("precision", "recall", "f_score")
_TIME = "prediction_time_lt"


@figure(section="forecasts", position=30, cases="networks", needs_networks=True)
def draw(
    *,
    percentiles: pd.DataFrame = read("case/tables/classification_percentiles.csv"),
    fixed_neurons: float = at("figures.fixed_neurons"),
    fixed_prediction_time_lt: float = at("shown.fixed_prediction_time_lt"),
    sizes_validation: str = at("shown.example.name.validation"),
    published: pd.DataFrame | None = None,
) -> Figure:
    """Draw a column at a fixed size, one at a fixed time, and one of up to four sizes.

    The second takes three sizes, the third two; a single size has its panels side by side. Where
    the table has no such size, time or strategy, the nearest or the last is shown.
    """
    theirs = published_beside(percentiles, published, "classification")
    networks = percentiles[percentiles["forecaster"] == "esn"]
    neurons = medians.nearest_value(networks, "neurons", fixed_neurons)
    time = medians.nearest_value(networks, _TIME, fixed_prediction_time_lt)
    validations = looks.ordered_validations(networks["validation"].dropna())
    sizes = np.unique(networks["neurons"].dropna().to_numpy(dtype=np.float64))
    if sizes_validation not in validations:
        sizes_validation = validations[-1]
    theirs = theirs[theirs["neurons"].isin(sizes)]

    columns = {"size": f"{neurons:g} neurons"}
    if len(sizes) > 2:
        columns["time"] = f"PT = {time:g} LT"
    if len(sizes) > 1:
        columns["strategy"] = sizes_validation
    several = len(columns) > 1
    figure = style.new_figure(style.DOUBLE_COLUMN, 5.6 if several else 2.5)
    shape = (3, len(columns)) if several else (1, 3)
    grid = figure.subplots(*shape, sharex="col", sharey=True, squeeze=False)
    panels = dict(zip(columns, grid.T if several else grid, strict=True))
    for row, metric in enumerate(_METRICS):
        first = panels["size"][row]
        # side by side, without the equations from the true state, which are right throughout
        left_out = [] if several else ["equations"]
        medians.draw_references(
            first, percentiles, metric, _TIME, neurons=neurons, leave_out=left_out
        )
        first.set_ylabel(medians.LABELS[metric])
        for validation in validations:
            look = looks.validation(validation)
            chosen = {"metric": metric, "validation": validation}
            of_size, at_time = {**chosen, "neurons": neurons}, {**chosen, _TIME: time}
            medians.draw_both(first, networks, theirs, of_size, _TIME, look, label=validation)
            if "time" in columns:
                curves = panels["time"][row], networks, theirs, at_time
                medians.draw_both(*curves, "neurons", look, label=validation)
        if "strategy" in columns:
            some = looks.few_of(sizes)
            for size, look in zip(some, looks.sequence(len(some)), strict=True):
                of_size = {"metric": metric, "validation": sizes_validation, "neurons": float(size)}
                curves = panels["strategy"][row], networks, theirs, of_size
                medians.draw_both(*curves, _TIME, look, label=f"{size:g}")
    lowest = min((panel.dataLim.y0 for panel in grid.flat if panel.has_data()), default=0.0)
    grid[0, 0].set_ylim(max(0.0, np.floor(10 * lowest) / 10), 1.02)
    more = [*medians.spread_handles(grid.flat), *medians.published_handles(grid.flat)]
    style.legend_above(figure, panels["size"] if several else [], more, columns=4)
    medians.say_where_empty(grid.flat)
    for column, (top, _, bottom) in panels.items():
        top.set_title(columns[column], loc="center")
        for axes in [bottom] if several else grid[0]:
            axes.set_xlabel(medians.NEURONS if column == "time" else medians.PREDICTION_TIME)
        if column == "time":
            top.set_xticks(sizes, [f"{size:g}" for size in sizes])
            top.margins(x=0.08)
            medians.thin_size_labels(bottom, sizes)
        else:
            top.xaxis.set_major_locator(MultipleLocator(1))
    if "strategy" in columns and panels["strategy"][2].has_data():
        panels["strategy"][2].legend(title="neurons", loc="best", ncols=2 if len(sizes) > 3 else 1)
    style.letter_panels(list(grid.flat))
    if not several:
        for axes in grid[0, 1:]:
            axes.xaxis.set_major_locator(MultipleLocator(1))
        style.label_ends(figure, grid[0, 2:])
    return figure
