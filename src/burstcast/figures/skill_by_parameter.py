"""Forecasters that know the parameter, against its value, a row for each family: F-score some time
ahead and (last column) escape rate from the turbulent state. Dashed vertical lines: values that
were trained on; at the others, which were never seen, markers are open. For comparison: forecasters
that were trained at each value. Bars: bootstrap intervals over test series; of escape rates,
confidence intervals.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from burstcast.base.declared import at, read
from burstcast.figures.parts import looks, medians, style
from burstcast.figures.registry import figure

_RATE_UNIT = 1e-4
_TRAINED: dict[str, Any] = {
    "color": style.GREY,
    "linewidth": 0.6,
    "linestyle": (0, (4, 3)),
    "zorder": 0.5,
}


@figure(section="forecasts", position=70, cases="several_parameters")
def draw(
    *,
    scores: Sequence[pd.DataFrame] = read("aware_cases/tables/classification.csv"),
    intervals: Sequence[pd.DataFrame] = read("aware_cases/tables/classification_intervals.csv"),
    survivals: Sequence[pd.DataFrame] = read("aware_cases/tables/survival.csv"),
    parameter: Mapping[str, Any] = at("shown.parameter"),
    prediction_times_lt: Sequence[float] = at("shown.prediction_times_lt"),
    neurons: int = at("figures.fixed_neurons"),
) -> Figure:
    """Draw a column for each prediction time that there is, and one of the escape rates.

    Networks that differ by their seeds are shown by their medians. ``parameter``: ``name`` of the
    parameter, its ``values`` by case, the ``trained`` values, and the ``kinds`` of forecasters that
    know it.
    """
    bars = pd.concat(list(intervals))
    bars = bars[bars["metric"] == "f_score"].drop(columns="metric")
    f_scores = pd.concat(list(scores))
    keys = [name for name in f_scores.columns if name in bars.columns]
    f_scores = f_scores.merge(bars, on=keys, how="left").rename(columns={"f_score": "value"})
    names = {"escape_rate": "value", "escape_rate_low": "low", "escape_rate_high": "high"}
    escapes = pd.concat(list(survivals)).rename(columns=names)
    escapes = escapes.assign(**(escapes[["value", "low", "high"]] / _RATE_UNIT))
    f_scores = f_scores[f_scores["neurons"].isna() | (f_scores["neurons"] == neurons)]
    escapes = escapes[escapes["neurons"].isna() | (escapes["neurons"] == neurons)]
    times = [time for time in prediction_times_lt if time in set(f_scores["prediction_time_lt"])]
    of_columns = [f_scores[f_scores["prediction_time_lt"] == time] for time in times] + [escapes]
    families = looks.families({*f_scores["forecaster"]} - {"permanent_alarm"})
    figure = style.new_figure(style.DOUBLE_COLUMN, 1.0 + 1.9 * len(families))
    grid = figure.subplots(len(families), len(of_columns), sharex=True, sharey="col", squeeze=False)
    for panels, (_, kinds) in zip(grid, families, strict=True):
        for axes, rows in zip(panels, of_columns, strict=True):
            for value in parameter["trained"]:
                axes.axvline(value, **_TRAINED)
            named = rows.assign(parameter=rows["case"].map(parameter["values"]))
            for number, kind in enumerate(["data", *kinds]):
                by_value = named[named["forecaster"] == kind].groupby("parameter")
                of_kind = by_value[["value", "low", "high"]].median().dropna(subset="value")
                if not of_kind.empty:
                    _draw(axes, of_kind.reset_index(), kind, number, parameter)
            axes.margins(x=0.08)
        for axes, time in zip(panels, times, strict=False):
            axes.set_ylim(0, 1)
            axes.set_ylabel(f"{medians.LABELS['f_score']}, {time:g} LT ahead")
        panels[-1].set_ylim(bottom=0)
        panels[-1].set_ylabel(r"Escape rate [$10^{-4}$ / time unit]")
    name = parameter["name"]
    label = "Reynolds number" if name == "reynolds" else name.replace("_", " ").capitalize()
    for axes in grid[-1]:
        axes.set_xlabel(label)
    medians.say_where_empty(grid.flat)
    trained = Line2D([], [], **_TRAINED, label="values trained on")
    more = [trained, style.bar_handle("interval", caps=False)]
    style.legend_above(figure, [*grid[:, -1], *grid[:, 0]], more, 3)
    style.letter_panels(list(grid.flat))
    return figure


def _draw(
    axes: Axes, rows: pd.DataFrame, kind: str, number: int, parameter: Mapping[str, Any]
) -> None:
    """Draw one kind, its markers open at values of the parameter that it was not trained on."""
    span = max(parameter["values"].values()) - min(parameter["values"].values())
    look = {**looks.forecaster_lines([kind])[kind], "linewidth": 0.9, "markersize": 3.5}
    look["marker"] = looks.OPEN_MARKERS[number % len(looks.OPEN_MARKERS)]
    if kind == "data":
        look |= {"label": "true flow", "color": style.BLACK, "linestyle": "-"}
    at = rows["parameter"].to_numpy(dtype=np.float64)
    position = at + 0.008 * span * (number - 2)
    value = rows["value"].to_numpy(dtype=np.float64)
    bars = medians.lengths(rows, "value", "low", "high")
    axes.errorbar(position, value, yerr=bars, elinewidth=0.6, **look)
    if kind in parameter["kinds"]:
        unseen = ~np.isclose(at[:, None], parameter["trained"]).any(axis=1)
        look |= {"linestyle": "", "markerfacecolor": "white", "label": None, "zorder": 4}
        axes.add_line(Line2D(position[unseen], value[unseen], **look))
