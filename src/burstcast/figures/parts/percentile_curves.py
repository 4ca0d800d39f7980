"""Curves of the median over an ensemble of networks, with the range between its quartiles."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.transforms import offset_copy

from burstcast.figures.parts.style import GREY, MarkerStyle, band_handle, bar_handle

METRIC_LABELS = {
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
"""Labels of axes, by the name of the metric in the percentile tables."""

PREDICTION_TIME_LABEL = "Prediction time [LT]"
NEURONS_LABEL = "Neurons"

_PUBLISHED = "published"
"""Mark of the lines that are published values."""

_BAND, _BARS, _SINGLE = "band", "bars", "single"
"""Marks of bands and bars over an ensemble, and of bars of one network."""


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


def require_single_case(table: pd.DataFrame) -> None:
    """Check that a percentile table holds one case only, as a figure without a case axis must."""
    if "case" in table.columns and table["case"].nunique() > 1:
        cases = ", ".join(str(case) for case in table["case"].unique())
        raise ValueError(f"the figure shows one case, the table has {cases}")


def nearest_value(table: pd.DataFrame, column: str, wanted: float) -> float:
    """Value of the column that lies nearest to the one wanted."""
    values = np.unique(table[column].dropna().to_numpy(dtype=np.float64))
    if values.size == 0:
        raise ValueError(f"the table has no value in column {column}")
    return float(values[np.argmin(np.abs(values - wanted))])


def draw_percentiles(
    axes: Axes,
    rows: pd.DataFrame,
    x: str,
    style: MarkerStyle,
    *,
    label: str | None = None,
    band: bool = True,
    shift: float = 0.0,
) -> None:
    """Draw the median of a metric against a column: a line, and the quartiles as a band.

    A single point, two sizes, or ``band=False`` show the quartiles as error bars. The quartiles of
    one network are its median: no band or bar then. Nothing is drawn for no rows.

    ``rows``: Rows of a percentile table: one per value of ``x``. ``shift``: Added to ``x``, so that
    error bars of several curves stay apart.
    """
    if rows.empty:
        return
    rows = rows.sort_values(x)
    position = rows[x].to_numpy(dtype=np.float64) + shift
    low, median, high = (rows[name].to_numpy(dtype=np.float64) for name in ("p25", "p50", "p75"))
    keywords: dict[str, Any] = {**style}
    if x == "neurons" and len(rows) == 2:
        keywords["linestyle"] = "none"  # a line through two sizes would tell of a trend
    if not (low < high).any():
        axes.plot(position, median, label=label, **keywords)
    elif band and len(rows) > 1 and keywords["linestyle"] != "none":
        filled = axes.fill_between(
            position, low, high, color=style["color"], alpha=0.22, linewidth=0
        )
        filled.set_gid(_BAND)
        axes.plot(position, median, label=label, **keywords)
    else:
        bars = axes.errorbar(
            position,
            median,
            # A published median may come without quartiles: no bar then.
            yerr=np.nan_to_num([median - low, high - median]),
            label=label,
            capsize=2.0,
            elinewidth=0.8,
            capthick=0.8,
            **keywords,
        )
        bars[2][0].set_gid(_BARS)


def draw_single_intervals(
    axes: Axes, intervals: pd.DataFrame, metric: str, validation: str, style: MarkerStyle
) -> None:
    """Draw how far one network's value may be off, as thin bars against reservoir size.

    Quartiles over networks do not tell that.

    ``intervals``: Intervals of each forecaster by itself: forecaster, neurons, validation, metric,
    low, high. The bar of a size has the medians over its networks, of the kind ``esn``.
    """
    shown = (intervals["metric"] == metric) & (intervals["validation"] == validation)
    rows = intervals[shown & (intervals["forecaster"] == "esn")].dropna(subset=["low", "high"])
    if not rows.empty:
        ends = rows.groupby("neurons")[["low", "high"]].median()
        figure = axes.get_figure(root=True)
        bars = axes.vlines(
            ends.index.to_numpy(dtype=np.float64),
            ends["low"],
            ends["high"],
            color=style["color"],
            linewidth=0.8,
            alpha=0.8,
            zorder=1.8,
            # beside quartiles that are bars themselves
            transform=offset_copy(axes.transData, figure, x=3, units="points"),
        )
        bars.set_gid(_SINGLE)
        low_and_high = ends.reset_index().melt("neurons")
        axes.update_datalim(low_and_high[["neurons", "value"]].to_numpy(dtype=np.float64))


def draw_published(
    axes: Axes, rows: pd.DataFrame, x: str, style: MarkerStyle, *, shift: float = 0.0
) -> None:
    """Draw published percentiles as open markers with error bars; nothing for no rows."""
    if rows.empty:
        return
    low, median, high = (rows[name].to_numpy(dtype=np.float64) for name in ("p25", "p50", "p75"))
    axes.errorbar(
        rows[x].to_numpy(dtype=np.float64) + shift,
        median,
        yerr=np.nan_to_num([median - low, high - median]),
        gid=_PUBLISHED,
        linestyle="none",
        marker=style["marker"],
        markersize=5.0,
        markerfacecolor="none",
        markeredgecolor=style["color"],
        markeredgewidth=0.8,
        ecolor=style["color"],
        elinewidth=0.6,
        capsize=1.5,
        zorder=3,
    )


def say_where_empty(panels: Iterable[Axes]) -> None:
    """Write into each panel without any curve that its metric is undefined: no event, say."""
    for panel in panels:
        if not panel.has_data():
            panel.text(
                0.5,
                0.5,
                "undefined",
                transform=panel.transAxes,
                ha="center",
                va="center",
                color=GREY,
            )


def draw_published_level(axes: Axes, rows: pd.DataFrame, color: str) -> None:
    """Draw published medians that no axis runs along as open markers on the right edge."""
    for value in rows["p50"]:
        axes.plot(
            1.0,
            float(value),
            gid=_PUBLISHED,
            transform=axes.get_yaxis_transform(),
            marker="D",
            markersize=4.5,
            markerfacecolor="none",
            markeredgecolor=color,
            markeredgewidth=0.9,
            clip_on=False,
            zorder=3,
        )


def spread_handles(
    panels: Iterable[Axes], over: str = "quartiles over networks", color: str = GREY
) -> list[Artist]:
    """Entries of a legend that say what bands and bars of the panels are, if there are any."""
    drawn = {shown.get_gid() for panel in panels for shown in panel.collections}
    handles: list[Artist] = []
    if _BAND in drawn:
        handles.append(band_handle(over, color))
    elif _BARS in drawn:
        handles.append(bar_handle(over))
    if _SINGLE in drawn:
        handles.append(bar_handle("interval of one network", caps=False))
    return handles


def published_handles(panels: Iterable[Axes]) -> list[Line2D]:
    """Entry of a legend for published values, if any of the panels shows some."""
    if not any(line.get_gid() == _PUBLISHED for panel in panels for line in panel.get_lines()):
        return []
    return [
        Line2D(
            [], [], linestyle="none", marker="o", mfc="none", mec="black", ms=5.0, label="published"
        )
    ]
