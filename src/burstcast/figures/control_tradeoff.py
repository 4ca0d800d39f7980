"""(a) Share of the exceedance of the event threshold that control removes and (b) actuation duty
cycle, by forecaster and prediction time: medians over the networks of an ensemble. Bars: bootstrap
intervals over flows, of networks the medians of their ends. For comparison: alarms by the equations
themselves, started from the true state, and random alarms at the rate of the networks'. Open
markers, if any: the paper's exceedance with control, over ours without control.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from burstcast.base.declared import at, read
from burstcast.figures.parts import looks, medians, style
from burstcast.figures.parts.published import published_beside, published_reductions
from burstcast.figures.registry import figure
from burstcast.forecasters._labels import forecaster_label

_LABELS = {"esn": "echo state networks", "equations": "equations", "random": "random alarms"}
_AXES = {
    "reduction": r"Reduction of $P({symbol} \geq {symbol}_e)$",
    "control_fraction": "Actuation duty cycle",
}
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
    present = list(shown["forecaster"].unique())
    kinds = sorted(present, key=[*_LABELS, *present].index)
    times = sorted(shown["prediction_time_lt"].dropna().unique())
    figure = style.new_figure(style.DOUBLE_COLUMN, 0.9 + 0.33 * len(kinds))
    panels = figure.subplots(1, 2, sharey=True)
    colours = dict(zip(times, looks.sequence(len(times)), strict=True))
    exceedances = published_beside(percentiles, published, "control")
    theirs = published_reductions(exceedances, shown)
    for axes, (metric, label) in zip(panels, _AXES.items(), strict=True):
        for time, look in colours.items():
            rows = medians.select(shown, metric=metric, prediction_time_lt=time)
            places = rows["forecaster"].map(kinds.index) + _apart(times, time)
            bars = medians.lengths(rows, "p50", "p25", "p75")
            marks = {**look, "linestyle": "none"}
            axes.errorbar(
                rows["p50"], places, xerr=bars, label=f"PT = {time:g} LT", **style.BARS, **marks
            )
            of_paper = medians.select(theirs, metric=metric, prediction_time_lt=time)
            for value in of_paper["p50"]:
                place = kinds.index("esn") + _apart(times, time)
                opened = {**marks, "markerfacecolor": "none", "markersize": 6.0}
                axes.plot(value, place, gid=medians.PUBLISHED, **opened)
        axes.set_xlabel(label.format(symbol=symbol))
        axes.margins(x=0.06)
    panels[0].axvline(0, color=style.GREY, linewidth=0.5, zorder=0.5)
    panels[0].set_yticks(
        range(len(kinds)), [_LABELS.get(kind, forecaster_label(kind)) for kind in kinds]
    )
    panels[0].set_ylim(len(kinds) - 0.5, -0.5)
    panels[1].set_xlim(left=0)
    more = [style.bar_handle("interval over flows"), *medians.published_handles(panels)]
    style.legend_above(figure, panels, more)
    style.letter_panels(panels)
    return figure


def _apart(times: Sequence[float], time: float) -> float:
    """Distance of a prediction time's marker from the middle of its row."""
    return 0.16 * (times.index(time) - 0.5 * (len(times) - 1))


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
