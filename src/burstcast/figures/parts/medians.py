"""Curves of medians over networks with their quartiles; other forecasters; published values."""

from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from burstcast.base.arrays import FloatArray
from burstcast.figures.parts import looks, style

LABELS = {
    "precision": "Precision, $p$",
    "recall": "Recall, $r$",
    "f_score": "F-score, $F$",
    "mean_horizon_lt": r"$\overline{\mathrm{PH}}_{\mathrm{ee}}$ [LT]",
    "kantorovich": r"Kantorovich metric, $\mathcal{K}$",
    "mean_log_error": "Mean logarithmic error, MLE",
    "nrmse_u": r"NRMSE of $\langle \overline{u} \rangle$",
    "nrmse_uu": r"NRMSE of $\langle \overline{u^2} \rangle$",
    "nrmse_uv": r"NRMSE of $\langle \overline{uv} \rangle$",
}
"""Labels of axes, by the name of the metric in the tables."""
PREDICTION_TIME = "Prediction time [LT]"
NEURONS = "Neurons"

PUBLISHED, _BAND, _BARS = "published", "band", "bars"
"""Marks of published values, and of bands and bars over an ensemble."""


def select(table: pd.DataFrame, **values: object) -> pd.DataFrame:
    """Rows of a percentile table that match all the values, without undefined medians."""
    matching = table["p50"].notna()
    for name, value in values.items():
        if isinstance(value, float):
            # Prediction times of 0.1 LT and the like come out of a file or an arithmetic
            # progression: equal but for rounding.
            matching &= np.isclose(table[name].astype(np.float64), value)
        else:
            matching &= table[name] == value
    return table[matching]


def with_intervals(percentiles: pd.DataFrame, intervals: pd.DataFrame) -> pd.DataFrame:
    """Rows of a percentile table with the interval of a single network, ``low`` and ``high``.

    Its ends are medians over the networks.
    """
    keys = [column for column in percentiles if column in intervals]
    ends = intervals.groupby(keys, dropna=False)[["low", "high"]].median().reset_index()
    return percentiles.merge(ends, on=keys, how="left")


def validations(networks: pd.DataFrame) -> Iterator[tuple[str, Any, Any]]:
    """Name, look and rows of each validation strategy of the networks."""
    for name in looks.ordered_validations(networks["validation"].dropna()):
        yield name, looks.validation(name), select(networks, validation=name)


def nearest_value(table: pd.DataFrame, column: str, wanted: float) -> float:
    """Value of the column that lies nearest to the one wanted."""
    values = np.unique(table[column].dropna().to_numpy(dtype=np.float64))
    if values.size == 0:
        raise ValueError(f"the table has no value in column {column}")
    return float(values[np.argmin(np.abs(values - wanted))])


def lengths(rows: pd.DataFrame, value: str, low: str, high: str) -> FloatArray:
    """Lengths of bars below and above, ``(2, rows)``: none where an end is missing or inside."""
    middle, below, above = (rows[name].to_numpy(dtype=np.float64) for name in (value, low, high))
    bars: FloatArray = np.clip(np.nan_to_num([middle - below, above - middle]), 0.0, None)
    return bars


def draw(
    axes: Axes,
    rows: pd.DataFrame,
    x: str,
    look: looks.MarkerStyle,
    *,
    label: str | None = None,
    band: bool = True,
    shift: float = 0.0,
) -> None:
    """Draw the median of a metric against a column: a line, and the quartiles as a band.

    A single point, two sizes, or ``band=False`` show the quartiles as error bars. The quartiles of
    one network are its median: no band or bar then. ``rows``: One for each value of ``x``, or none.
    ``shift``: Added to ``x``, so that error bars of several curves stay apart.
    """
    if rows.empty:
        return
    rows = rows.sort_values(x)
    position = rows[x].to_numpy(dtype=np.float64) + shift
    low, median, high = (rows[name].to_numpy(dtype=np.float64) for name in ("p25", "p50", "p75"))
    keywords: dict[str, Any] = {**look, "label": label}
    if x == "neurons" and len(rows) == 2:
        keywords["linestyle"] = "none"  # a line through two sizes would tell of a trend
    if not (low < high).any():
        axes.plot(position, median, **keywords)
    elif band and len(rows) > 1 and keywords["linestyle"] != "none":
        filled = axes.fill_between(
            position, low, high, color=look["color"], alpha=0.22, linewidth=0
        )
        filled.set_gid(_BAND)
        axes.plot(position, median, **keywords)
    else:
        # A published median may come without quartiles: no bar then.
        bar = np.nan_to_num([median - low, high - median])
        bars = axes.errorbar(position, median, yerr=bar, **style.BARS, **keywords)
        bars[2][0].set_gid(_BARS)


def draw_references(
    axes: Axes,
    percentiles: pd.DataFrame,
    metric: str,
    x: str,
    *,
    neurons: float | None = None,
    leave_out: Collection[str] = (),
) -> None:
    """Draw the forecasters of other kinds than ``esn``: the median of a metric as a quiet line.

    A kind that has sizes has a line for each validation strategy; against ``neurons``, kinds
    without sizes are horizontal lines. ``neurons``: Size that is shown against another column.
    """
    kinds = set(percentiles["forecaster"].dropna()) - {"esn", *leave_out}
    for kind, look in looks.forecaster_lines(kinds).items():
        rows = select(percentiles, forecaster=kind, metric=metric)
        if x != "neurons":
            rows = rows[rows["neurons"].isna() | (rows["neurons"] == neurons)]
        line = {**look, "linewidth": 1.0, "zorder": 1.5}
        for _, curve in rows.groupby("validation", dropna=False):
            if curve[x].isna().all():
                axes.axhline(float(curve["p50"].iloc[0]), **line)
            else:
                curve = curve.sort_values(x)
                axes.plot(curve[x], curve["p50"], **line, marker="." if len(curve) == 1 else "")
            line["label"] = ""


def draw_published(
    axes: Axes, rows: pd.DataFrame, x: str, look: looks.MarkerStyle, *, shift: float = 0.0
) -> None:
    """Draw published percentiles as open markers, with error bars if there are quartiles."""
    if rows.empty:
        return
    bars = lengths(rows, "p50", "p25", "p75") if "p25" in rows else None
    axes.errorbar(
        rows[x].to_numpy(dtype=np.float64) + shift,
        rows["p50"].to_numpy(dtype=np.float64),
        yerr=bars,
        gid=PUBLISHED,
        linestyle="none",
        marker=look["marker"],
        markersize=5.0,
        markerfacecolor="none",
        markeredgecolor=look["color"],
        markeredgewidth=0.8,
        ecolor=look["color"],
        elinewidth=0.6,
        capsize=1.5,
        zorder=3,
    )


def draw_both(
    axes: Axes,
    ours: pd.DataFrame,
    theirs: pd.DataFrame,
    chosen: Mapping[str, object],
    x: str,
    look: looks.MarkerStyle,
    **how: Any,
) -> None:
    """Draw the chosen rows of our table (`draw`), and of the published one."""
    draw(axes, select(ours, **chosen), x, look, **how)
    shift = how.get("shift", 0.0)
    draw_published(axes, select(theirs, **chosen), x, look, shift=shift)


def draw_published_level(axes: Axes, rows: pd.DataFrame, color: str) -> None:
    """Draw published medians that no axis runs along as open markers on the right edge."""
    for value in rows["p50"]:
        axes.plot(
            1.0,
            float(value),
            gid=PUBLISHED,
            transform=axes.get_yaxis_transform(),
            marker="D",
            markersize=4.5,
            markerfacecolor="none",
            markeredgecolor=color,
            markeredgewidth=0.9,
            clip_on=False,
            zorder=3,
        )


def thin_size_labels(axes: Axes, sizes: Collection[float]) -> None:
    """Hide every second label of more than four sizes."""
    if len(sizes) > 4:
        for index, label in enumerate(axes.get_xticklabels()):
            label.set_visible(index % 2 == 1)


def say_where_empty(panels: Iterable[Axes]) -> None:
    """Write into each panel without any curve that its metric is undefined: no event, say."""
    for panel in panels:
        if not panel.has_data():
            place: dict[str, Any] = {"transform": panel.transAxes, "ha": "center", "va": "center"}
            panel.text(0.5, 0.5, "undefined", color=style.GREY, **place)


def spread_handles(
    panels: Iterable[Axes], over: str = "quartiles over networks", color: str = style.GREY
) -> list[Artist]:
    """Entries of a legend that say what bands and bars of the panels are, if there are any."""
    drawn = {shown.get_gid() for panel in panels for shown in panel.collections}
    handles: list[Artist] = []
    if _BAND in drawn:
        handles.append(style.band_handle(over, color))
    elif _BARS in drawn:
        handles.append(style.bar_handle(over))
    return handles


def published_handles(panels: Iterable[Axes]) -> list[Artist]:
    """Entry of a legend for published values, if any of the panels shows some."""
    if not any(line.get_gid() == PUBLISHED for panel in panels for line in panel.get_lines()):
        return []
    look: dict[str, Any] = {"marker": "o", "mfc": "none", "mec": "black", "ms": 5.0}
    return [Line2D([], [], linestyle="none", label="published", **look)]
