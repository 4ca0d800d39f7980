"""(a) Mean prediction horizon of extreme events and (b, ...) F-score some time ahead, against the
Reynolds number; last row: F-score against prediction time, a panel for each validation strategy.
Medians and quartiles over the networks of an ensemble.
"""

from collections.abc import Sequence
from math import lcm

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from burstcast.base.declared import at, read
from burstcast.figures.parts import looks, medians, style
from burstcast.figures.parts.published import published_beside
from burstcast.figures.registry import figure


@figure(section="horizon", position=40, cases="several_reynolds", needs_networks=True)
def draw(
    *,
    horizons: Sequence[pd.DataFrame] = read("reynolds_cases/tables/horizon_percentiles.csv"),
    scores: Sequence[pd.DataFrame] = read("reynolds_cases/tables/classification_percentiles.csv"),
    neurons: float = at("figures.fixed_neurons"),
    prediction_times_lt: Sequence[float] = at("shown.prediction_times_lt"),
    published: pd.DataFrame | None = None,
) -> Figure:
    """Draw scores of networks of one size, from the percentile tables of each case.

    Rows without a Reynolds number are ignored; cases may have other prediction times than each
    other.
    """
    ours: dict[str, pd.DataFrame] = {}
    theirs: dict[str, pd.DataFrame] = {}
    for name, tables in (("horizon", horizons), ("classification", scores)):
        table = pd.concat(tables, ignore_index=True)
        beside = published_beside(table, published, name)
        of_size: dict[str, object] = {"forecaster": "esn", "neurons": float(neurons)}
        ours[name] = medians.select(table, **of_size).dropna(subset=["reynolds"])
        theirs[name] = medians.select(beside, **of_size).dropna(subset=["reynolds"])
    networks = pd.concat(ours.values())
    reynolds = np.unique(networks["reynolds"].astype(np.float64))
    if reynolds.size == 0:
        raise ValueError(f"no network of {neurons:g} neurons has a Reynolds number")
    theirs = {name: rows[rows["reynolds"].isin(reynolds)] for name, rows in theirs.items()}
    validations = looks.ordered_validations(networks["validation"].dropna())

    figure = style.new_figure(style.DOUBLE_COLUMN, 4.9)
    counts = 1 + len(prediction_times_lt), len(validations)
    columns = lcm(*counts)
    grid = figure.add_gridspec(2, columns, height_ratios=[1.0, 1.25])
    upper, lower = (
        [
            figure.add_subplot(grid[row, columns * index // count : columns * (index + 1) // count])
            for index in range(count)
        ]
        for row, count in enumerate(counts)
    )
    # Error bars of the strategies stand side by side.
    spacing = 0.03 * (float(np.ptp(reynolds)) or 100.0)
    places = spacing * (np.arange(len(validations)) - 0.5 * (len(validations) - 1))
    metrics: list[tuple[str, dict[str, object]]] = [("horizon", {"metric": "mean_horizon_lt"})]
    for time in prediction_times_lt:
        chosen = {"metric": "f_score", "prediction_time_lt": float(time)}
        metrics.append(("classification", chosen))
    for panel, (name, chosen) in zip(upper, metrics, strict=True):
        panel.set_ylabel(medians.LABELS[str(chosen["metric"])])
        for validation, shift in zip(validations, places, strict=True):
            look = looks.validation(validation)
            curves = panel, ours[name], theirs[name], {"validation": validation, **chosen}
            how = {"label": validation, "band": False, "shift": shift}
            medians.draw_both(*curves, "reynolds", look, **how)
    for panel, time in zip(upper[1:], prediction_times_lt, strict=True):
        panel.set_title(f"{time:g} LT ahead", loc="center")
        panel.sharey(upper[1])
    for panel in upper:
        panel.set_xlabel("Reynolds number, Re")
        panel.set_xticks(reynolds)
        panel.margins(x=0.08, y=0.1)
    for panel, validation in zip(lower, validations, strict=True):
        for number, look in zip(reynolds, looks.sequence(len(reynolds)), strict=True):
            shown = {"metric": "f_score", "validation": validation, "reynolds": number}
            curves = panel, ours["classification"], theirs["classification"], shown
            medians.draw_both(*curves, "prediction_time_lt", look, label=f"{number:g}")
        panel.set_title(validation, loc="center")
        panel.set_xlabel(medians.PREDICTION_TIME)
        panel.set_ylabel(medians.LABELS["f_score"])
        panel.xaxis.set_major_locator(MultipleLocator(1))
        panel.sharex(lower[0])
        panel.sharey(lower[0])
        if panel.has_data():
            panel.legend(title="Re", loc="best")
    # panels that share an axis have the limits of the last one that was drawn
    drawn = [panel.dataLim for panel in lower if panel.has_data()]
    if drawn:
        low, high = min(box.y0 for box in drawn), max(box.y1 for box in drawn)
        lower[0].set_ylim(low - 0.05 * (high - low), high + 0.05 * (high - low))
    panels = [*upper, *lower]
    more = [*medians.spread_handles(upper), *medians.published_handles(panels)]
    style.legend_above(figure, upper, more)
    medians.say_where_empty(panels)
    style.letter_panels(panels)
    return figure
