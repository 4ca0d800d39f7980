"""Share of the exceedance of the event threshold that control removes, (a) against the prediction
time and (b) against the share of the time under actuation: medians over the networks of an
ensemble. Bands and bars: bootstrap intervals over flows, of networks the medians of their ends. For
comparison: alarms by the equations themselves, started from the true
state, and random alarms at the rate of the networks'. Open markers, if any: the paper's exceedance
with control, over ours without control.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast.figures.parts.percentile_curves import (
    PREDICTION_TIME_LABEL,
    draw_percentiles,
    draw_published,
    published_handles,
    require_single_case,
    select,
    spread_handles,
)
from burstcast.figures.parts.style import (
    BLACK,
    BLUE,
    DOUBLE_COLUMN,
    GREY,
    PURPLE,
    MarkerStyle,
    legend_above,
    letter_panels,
    new_figure,
    styled,
)
from burstcast.figures.registry import Declaration
from burstcast.forecasters._labels import forecaster_label
from burstcast.tables.published import published_beside, published_reductions

FIGURE = Declaration(
    section="control",
    position=30,
    inputs={
        "percentiles": "case/tables/control_percentiles.csv",
        "strategies": "case/tables/control_strategies.csv",
    },
    settings={"networks": "shown.control_networks", "symbol": "shown.symbol"},
    cases="controlled",
    published=True,
)

_FORECASTERS = {
    "esn": (
        "echo state networks",
        MarkerStyle(color=BLUE, linestyle="-", linewidth=1.2, marker="o"),
    ),
    "equations": (
        "equations",
        MarkerStyle(color=BLACK, linestyle=(0, (4.0, 1.5)), linewidth=1.0, marker="s"),
    ),
    "random": (
        "random alarms",
        MarkerStyle(color=GREY, linestyle=(0, (1.0, 1.0)), linewidth=1.2, marker="^"),
    ),
}
_OTHER = MarkerStyle(color=PURPLE, linestyle="-", linewidth=1.0, marker="D")


def draw(
    *,
    percentiles: pd.DataFrame,
    strategies: pd.DataFrame,
    networks: Mapping[str, Any],
    symbol: str,
    published: pd.DataFrame | None = None,
) -> Figure:
    """Draw networks of one kind, and the forecasters to compare them with.

    ``networks`` holds ``neurons`` and ``validation`` of the networks that are shown.
    """
    of_kind = (percentiles["neurons"] == networks["neurons"]) & (
        percentiles["validation"] == networks["validation"]
    )
    shown = over_flows(percentiles[percentiles["neurons"].isna() | of_kind], strategies)
    exceedances = published_beside(percentiles, published, "control")
    reductions = None if exceedances is None else published_reductions(exceedances, shown)
    return control_tradeoff(shown, symbol=symbol, published=reductions)


_ENDS = {"reduction": "relative_exceedance", "control_fraction": "control_fraction"}
_PAPERS = {"strategy": "prediction_triggered", "starts": "quiet"} | {
    "delay_lt": 0.0,
    "quiet_lt": 0.0,
    "strength": 1.0,
}
"""What the paper's control is among all strategies."""


def over_flows(percentiles: pd.DataFrame, strategies: pd.DataFrame) -> pd.DataFrame:
    """Replace quartiles over networks by intervals over flows: p25 and p75 are their ends.

    Networks are few, and react to the same flows: their quartiles say nothing about other flows.

    ``percentiles``: Percentiles of one case: forecaster, neurons, validation, prediction_time_lt,
    metric, p25, p50, p75. ``strategies``: Costs and gains of control of the same case: the same
    keys, seed, strategy, metric, low, high.
    """
    papers = strategies
    for name, value in _PAPERS.items():
        papers = papers[papers[name] == value]
    shown = percentiles.copy()
    for index, row in shown.iterrows():
        if row["metric"] not in _ENDS:
            continue
        same = papers["metric"] == _ENDS[row["metric"]]
        for name in ("forecaster", "neurons", "validation", "prediction_time_lt"):
            missing = pd.isna(row[name])
            same &= papers[name].isna() if missing else papers[name] == row[name]
        low, high = papers.loc[same, "low"].median(), papers.loc[same, "high"].median()
        if row["metric"] == "reduction":
            low, high = 1 - high, 1 - low
        shown.loc[index, ["p25", "p75"]] = [low, high]
    return shown


@styled
def control_tradeoff(
    percentiles: pd.DataFrame, *, symbol: str = "k", published: pd.DataFrame | None = None
) -> Figure:
    """Draw the reduction against (a) the prediction time and (b) the time under control.

    Error bars and bands are intervals over flows; in (b) each point is a prediction time.

    ``percentiles``: Percentiles of one case, one size and one strategy: forecaster,
    prediction_time_lt, metric (``reduction``, ``control_fraction``), p50, and the ends p25 and p75
    (`over_flows`). ``published``: Published reductions by networks of this size and strategy in the
    same form, drawn as open markers in (a). Returns the figure; one that says why it is empty where
    no reduction is defined.
    """
    require_single_case(percentiles)
    if select(percentiles, metric="reduction").empty:
        return nothing_to_show("Without control no event occurred that control could prevent.")
    figure = new_figure(DOUBLE_COLUMN, 2.6)
    left, right = figure.subplots(1, 2, sharey=True)
    present = list(percentiles["forecaster"].unique())
    for forecaster in sorted(present, key=[*_FORECASTERS, *present].index):
        name, style = _FORECASTERS.get(forecaster, (forecaster_label(str(forecaster)), _OTHER))
        reduction = select(percentiles, forecaster=forecaster, metric="reduction")
        fraction = select(percentiles, forecaster=forecaster, metric="control_fraction")
        draw_percentiles(left, reduction, "prediction_time_lt", style, label=name)
        both = fraction.merge(reduction, on="prediction_time_lt", suffixes=("_x", "_y"))
        _draw_both(right, both.sort_values("prediction_time_lt"), style)
        if forecaster == "esn":
            for row in both.to_dict("records"):
                # at the right end of its bar
                right.annotate(
                    f"{row['prediction_time_lt']:g} LT",
                    (row["p75_x"], row["p50_y"]),
                    (3, 0),
                    "data",
                    "offset points",
                    ha="left",
                    va="top",
                    color=style["color"],
                    path_effects=[withStroke(linewidth=2.0, foreground="white")],
                    zorder=5,
                )
    if published is not None:
        rows = select(published, metric="reduction")
        draw_published(left, rows, "prediction_time_lt", _FORECASTERS["esn"][1])
    left.set_xticks(sorted(percentiles["prediction_time_lt"].dropna().unique()))
    left.margins(x=0.06)
    # Zero is shown, and neither a marker nor the label below it is cut.
    lowest = min(0.0, left.dataLim.y0, right.dataLim.y0)
    highest = max(left.dataLim.y1, right.dataLim.y1)
    room = 0.06 * (highest - lowest or 1.0)
    left.set_ylim(lowest - 2 * room, highest + 2 * room)
    for panel in (left, right):
        panel.axhline(0, color=GREY, linewidth=0.5, zorder=0.5)
    left.set_xlabel(PREDICTION_TIME_LABEL)
    left.set_ylabel(rf"Reduction of $P({symbol} \geq {symbol}_e)$")
    right.set_xlabel("Fraction of time under control")
    right.margins(x=0.12)
    more = [*spread_handles([left], "interval over flows"), *published_handles([left])]
    legend_above(figure, [left], more)
    letter_panels([left, right])
    return figure


def _draw_both(axes: Axes, both: pd.DataFrame, style: MarkerStyle) -> None:
    """Draw one metric against another, with intervals of both."""
    bars = {
        f"{axis}err": np.array(
            [
                both[f"p50_{axis}"] - both[f"p25_{axis}"],
                both[f"p75_{axis}"] - both[f"p50_{axis}"],
            ]
        )
        for axis in ("x", "y")
    }
    keywords: dict[str, Any] = {**style, **bars}
    axes.errorbar(
        both["p50_x"], both["p50_y"], capsize=2.0, elinewidth=0.8, capthick=0.8, **keywords
    )
