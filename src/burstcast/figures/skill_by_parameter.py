"""Forecasters that know the parameter, against its value: (a, ...) F-score some time ahead and
(last panel) escape rate from the turbulent state. Dashed vertical lines: values that were trained
on; at the others, which were never seen, markers are open. For comparison: forecasters that were
trained at each value. Bars: bootstrap intervals over test series; of escape rates, confidence
intervals.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from burstcast.arrays import FloatArray
from burstcast.figures.parts.percentile_curves import METRIC_LABELS, say_where_empty
from burstcast.figures.parts.reference_forecasters import forecaster_style, ordered_forecasters
from burstcast.figures.parts.style import (
    BLACK,
    DOUBLE_COLUMN,
    GREY,
    bar_handle,
    legend_above,
    letter_panels,
    new_figure,
    styled,
)
from burstcast.figures.registry import Declaration

FIGURE = Declaration(
    section="forecasts",
    position=70,
    inputs={
        "scores": "aware_cases/tables/classification.csv",
        "intervals": "aware_cases/tables/classification_intervals.csv",
        "survivals": "aware_cases/tables/survival.csv",
    },
    settings={
        "parameter": "shown.parameter",
        "prediction_times_lt": "figures.reynolds_prediction_times_lt",
        "neurons": "figures.fixed_neurons",
    },
    cases="several_parameters",
)

# markers that look different when they are open
_MARKERS = ("o", "s", "^", "D", "v", ">", "<")
_RATE_UNIT = 1e-4
_TRAINED: dict[str, Any] = {
    "color": GREY,
    "linewidth": 0.6,
    "linestyle": (0, (4, 3)),
    "zorder": 0.5,
}


def draw(
    *,
    scores: Sequence[pd.DataFrame],
    intervals: Sequence[pd.DataFrame],
    survivals: Sequence[pd.DataFrame],
    parameter: Mapping[str, Any],
    prediction_times_lt: Sequence[float],
    neurons: int,
) -> Figure:
    """Draw forecasters of all cases, networks of one size."""
    return skill_by_parameter(
        _of_size(scores, neurons),
        _of_size(intervals, neurons),
        _of_size(survivals, neurons),
        parameter,
        prediction_times_lt,
    )


def _of_size(tables: Sequence[pd.DataFrame], neurons: int) -> pd.DataFrame:
    """Rows of all cases, without networks of other sizes."""
    rows = pd.concat(list(tables))
    return rows[rows["neurons"].isna() | (rows["neurons"] == neurons)]


@styled
def skill_by_parameter(
    scores: pd.DataFrame,
    intervals: pd.DataFrame,
    survival: pd.DataFrame,
    parameter: Mapping[str, Any],
    prediction_times_lt: Sequence[float],
) -> Figure:
    """Draw a panel for each prediction time, and one of the escape rates.

    ``scores``: ``case``, ``forecaster``, ``prediction_time_lt``, ``f_score``: one row for each
    forecaster and time; networks that differ by their seeds are shown by their medians.
    ``intervals``: Intervals of the scores: the same keys, ``metric``, ``low``, ``high``.
    ``survival``: ``case``, ``forecaster`` ("data" for the true flow), ``escape_rate``,
    ``escape_rate_low``, ``escape_rate_high``. ``parameter``: ``name`` of the parameter, its
    ``values`` by case, the ``trained`` values, and the ``kinds`` of forecasters that know it.
    ``prediction_times_lt``: Prediction times of the panels; times that the scores do not have are
    left out.
    """
    times = [time for time in prediction_times_lt if time in set(scores["prediction_time_lt"])]
    bars = intervals[intervals["metric"] == "f_score"].drop(columns="metric")
    keys = [name for name in scores.columns if name in bars.columns]
    found = scores.merge(bars, on=keys, how="left").rename(columns={"f_score": "value"})
    escapes = survival.rename(
        columns={"escape_rate": "value", "escape_rate_low": "low", "escape_rate_high": "high"}
    )
    escapes = escapes.assign(**(escapes[["value", "low", "high"]] / _RATE_UNIT))
    of_panels = [*(found[found["prediction_time_lt"] == time] for time in times), escapes]
    kinds = ["data", *ordered_forecasters({*scores["forecaster"]} - {"permanent_alarm"})]
    figure = new_figure(DOUBLE_COLUMN, 3.0)
    panels: list[Axes] = list(figure.subplots(1, len(of_panels), squeeze=False)[0])
    for axes, rows in zip(panels, of_panels, strict=True):
        for value in parameter["trained"]:
            axes.axvline(value, **_TRAINED)
        for number, kind in enumerate(kinds):
            own = _by_value(rows[rows["forecaster"] == kind], parameter)
            if not own.empty:
                _draw(axes, own, kind, number, parameter)
        axes.set_xlabel(_parameter_label(parameter["name"]))
        axes.margins(x=0.08)
    for axes, time in zip(panels, times, strict=False):
        axes.set_ylim(0, 1)
        axes.set_ylabel(f"{METRIC_LABELS['f_score']}, {time:g} LT ahead")
    panels[-1].set_ylim(bottom=0)
    panels[-1].set_ylabel(r"Escape rate [$10^{-4}$ / time unit]")
    say_where_empty(panels)
    trained = Line2D([], [], **_TRAINED, label="values trained on")
    legend_above(
        figure, [panels[-1], *panels[:-1]], [trained, bar_handle("interval", caps=False)], 3
    )
    letter_panels(panels)
    return figure


def _by_value(rows: pd.DataFrame, parameter: Mapping[str, Any]) -> pd.DataFrame:
    """Medians over networks, in the order of the parameter."""
    named = rows.assign(parameter=rows["case"].map(parameter["values"]))
    found = named.groupby("parameter")[["value", "low", "high"]].median()
    return found.dropna(subset="value").reset_index()


def _draw(
    axes: Axes, rows: pd.DataFrame, kind: str, number: int, parameter: Mapping[str, Any]
) -> None:
    span = max(parameter["values"].values()) - min(parameter["values"].values())
    look = {**forecaster_style(kind), "linewidth": 0.9}
    if kind == "data":
        look |= {"label": "true flow", "color": BLACK, "linestyle": "-"}
    position = rows["parameter"].to_numpy(dtype=np.float64) + 0.008 * span * (number - 2)
    low, value, high = (rows[name].to_numpy(dtype=np.float64) for name in ("low", "value", "high"))
    lengths = np.clip(np.nan_to_num([value - low, high - value]), 0.0, None)
    marker = _MARKERS[number % len(_MARKERS)]
    axes.errorbar(
        position, value, yerr=lengths, marker=marker, markersize=3.5, elinewidth=0.6, **look
    )
    if kind in parameter["kinds"]:
        _open_markers(axes, position, value, rows["parameter"], marker, look["color"], parameter)


def _open_markers(
    axes: Axes,
    position: FloatArray,
    value: FloatArray,
    at: pd.Series,
    marker: str,
    color: str,
    parameter: Mapping[str, Any],
) -> None:
    unseen = ~np.isclose(at.to_numpy(dtype=np.float64)[:, None], parameter["trained"]).any(axis=1)
    axes.add_line(
        Line2D(
            position[unseen],
            value[unseen],
            linestyle="",
            marker=marker,
            markersize=3.5,
            markeredgecolor=color,
            markerfacecolor="white",
            zorder=4,
        )
    )


def _parameter_label(name: str) -> str:
    return "Reynolds number" if name == "reynolds" else name.replace("_", " ").capitalize()
