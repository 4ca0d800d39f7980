"""Share of the exceedance of the event threshold that control removes, (a) against the prediction
time and (b) against the share of the time under actuation: medians over the networks of an
ensemble. Bands and bars: bootstrap intervals over flows, of networks the medians of their ends. For
comparison: alarms by the equations themselves, started from the true
state, and random alarms at the rate of the networks'. Open markers, if any: the paper's exceedance
with control, over ours without control.
"""

from collections.abc import Mapping
from typing import Any

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from burstcast.base.declared import at, read
from burstcast.figures.parts import looks, medians, style
from burstcast.figures.parts.published import published_beside, published_reductions
from burstcast.figures.registry import figure
from burstcast.forecasters._labels import forecaster_label

_LABELS = {"esn": "echo state networks", "equations": "equations", "random": "random alarms"}
_ENDS = {"reduction": "relative_exceedance", "control_fraction": "control_fraction"}
_PAPERS = {"strategy": "prediction_triggered", "starts": "quiet"} | {
    "delay_lt": 0.0,
    "quiet_lt": 0.0,
    "strength": 1.0,
}
"""What the paper's control is among all strategies."""


@figure(section="control", position=30, cases="controlled")
def draw(
    *,
    percentiles: pd.DataFrame = read("case/tables/control_percentiles.csv"),
    strategies: pd.DataFrame = read("case/tables/control_strategies.csv"),
    networks: Mapping[str, Any] = at("shown.control_networks"),
    symbol: str = at("case.space.observable_symbol"),
    published: pd.DataFrame | None = None,
) -> Figure:
    """Draw networks of one kind (``neurons`` and ``validation``) beside other forecasters."""
    of_kind = (percentiles["neurons"] == networks["neurons"]) & (
        percentiles["validation"] == networks["validation"]
    )
    shown = over_flows(percentiles[percentiles["neurons"].isna() | of_kind], strategies)
    if medians.select(shown, metric="reduction").empty:
        return style.nothing_to_show(
            "Without control no event occurred that control could prevent."
        )
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.6)
    left, right = figure.subplots(1, 2, sharey=True)
    present = list(shown["forecaster"].unique())
    lines = looks.controller_lines(sorted(present, key=[*_LABELS, *present].index))
    for forecaster, look in lines.items():
        label = _LABELS.get(forecaster, forecaster_label(forecaster))
        reduction, fraction = (
            medians.select(shown, forecaster=forecaster, metric=metric) for metric in _ENDS
        )
        medians.draw(left, reduction, "prediction_time_lt", look, label=label)
        both = fraction.merge(reduction, on="prediction_time_lt", suffixes=("_x", "_y"))
        both = both.sort_values("prediction_time_lt")
        bars: dict[str, Any] = {
            f"{axis}err": medians.lengths(both, *(f"{end}_{axis}" for end in ("p50", "p25", "p75")))
            for axis in ("x", "y")
        }
        right.errorbar(both["p50_x"], both["p50_y"], **bars, **style.BARS, **look)
        for row in both.to_dict("records") if forecaster == "esn" else ():
            # at the right end of its bar
            right.annotate(
                f"{row['prediction_time_lt']:g} LT",
                (row["p75_x"], row["p50_y"]),
                (3, 0),
                "data",
                "offset points",
                ha="left",
                va="top",
                color=look["color"],
                path_effects=[withStroke(linewidth=2.0, foreground="white")],
                zorder=5,
            )
    exceedances = published_beside(percentiles, published, "control")
    rows = medians.select(published_reductions(exceedances, shown), metric="reduction")
    look = looks.controller_lines(["esn"])["esn"]
    medians.draw_published(left, rows, "prediction_time_lt", look)
    left.set_xticks(sorted(shown["prediction_time_lt"].dropna().unique()))
    left.margins(x=0.06)
    # Zero is shown, and neither a marker nor the label below it is cut.
    lowest = min(0.0, left.dataLim.y0, right.dataLim.y0)
    highest = max(left.dataLim.y1, right.dataLim.y1)
    room = 0.06 * (highest - lowest or 1.0)
    left.set_ylim(lowest - 2 * room, highest + 2 * room)
    for panel in (left, right):
        panel.axhline(0, color=style.GREY, linewidth=0.5, zorder=0.5)
    left.set_xlabel(medians.PREDICTION_TIME)
    left.set_ylabel(rf"Reduction of $P({symbol} \geq {symbol}_e)$")
    right.set_xlabel("Fraction of time under control")
    right.margins(x=0.12)
    more = medians.spread_handles([left], "interval over flows")
    style.legend_above(figure, [left], [*more, *medians.published_handles([left])])
    style.letter_panels([left, right])
    return figure


def over_flows(percentiles: pd.DataFrame, strategies: pd.DataFrame) -> pd.DataFrame:
    """Replace quartiles over networks by intervals over flows: p25 and p75 are their ends.

    Networks are few, and react to the same flows: their quartiles say nothing about other flows.
    ``strategies``: Costs and gains of control of the same case.
    """
    papers = strategies
    for name, value in _PAPERS.items():
        papers = papers[papers[name] == value]
    shown = percentiles.copy()
    for index, row in shown[shown["metric"].isin([*_ENDS])].iterrows():
        same = papers["metric"] == _ENDS[row["metric"]]
        for name in ("forecaster", "neurons", "validation", "prediction_time_lt"):
            same &= papers[name].isna() if pd.isna(row[name]) else papers[name] == row[name]
        low, high = papers.loc[same, "low"].median(), papers.loc[same, "high"].median()
        if row["metric"] == "reduction":
            low, high = 1 - high, 1 - low
        shown.loc[index, ["p25", "p75"]] = [low, high]
    return shown
