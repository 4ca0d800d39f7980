"""Exceedance of the event threshold that control leaves, as a share of that without control,
against the share of the time under actuation, with confidence intervals over flows: (a) rules,
random actuation and the paper's strategy, (b) strategies that compare forecasts with and without
actuation; their horizontal axes differ. Curves run along the horizon, the prediction time, the
level or the probability of actuation, which is written at the ends of some of them; "every" is the
interval between decisions. The vertical axis is linear in the shaded strip: a marker on 0 has left
nothing, and its bar ends at the bound of the rule of three. Colours and fillings distinguish
forecasters. One network is shown, and the committee of all networks of its size. The figure
control_conditions has other conditions.
"""

import math
from collections.abc import Mapping
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullFormatter

from burstcast.figures.parts.control_runs import (
    ACTING,
    COMPARING,
    LEFT,
    curve_style,
    draw_curve,
    forecaster_handles,
    forecasters_in_order,
    interval_lengths,
    kind_handles,
    left_label,
    linestyles_of,
    logarithmic_with_nothing,
    of_network,
    runs_of,
    strategy_look,
    usual_conditions,
    where,
    with_kinds,
)
from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast.figures.parts.percentile_curves import require_single_case
from burstcast.figures.parts.style import (
    DOUBLE_COLUMN,
    GREY,
    bar_handle,
    columns_that_fit,
    letter_panels,
    new_figure,
    styled,
)
from burstcast.figures.registry import Declaration

FIGURE = Declaration(
    section="control",
    position=50,
    inputs={"scores": "case/tables/control_strategies.csv"},
    settings={
        "network": "shown.frontier_network",
        "span_lt": "control.span_lt",
        "noise": "case.training.noise",
        "symbol": "shown.symbol",
    },
    cases="other_control",
)


def draw(
    *,
    scores: pd.DataFrame,
    network: Mapping[str, Any] | None,
    span_lt: float,
    noise: float,
    symbol: str,
) -> Figure:
    """Draw all strategies with one network, and the forecasters to compare it with.

    ``span_lt``, ``noise``: Usual length of a run and noise of the observations.
    """
    usual = {"span_lt": span_lt, "noise": noise}
    return control_frontier(of_network(scores, network), usual, symbol=symbol)


@styled
def control_frontier(
    scores: pd.DataFrame, usual: Mapping[str, float], *, symbol: str = "k"
) -> Figure:
    """Draw the share of the exceedance that is left against the share of time under actuation.

    Bars are confidence intervals over flows. The vertical axis is logarithmic, and linear in the
    shaded strip at its foot: "nothing left" has a place.

    ``scores``: A row for each run of control and metric (``relative_exceedance``,
    ``control_fraction``), of one case and one network at most: ``strategy``, its settings,
    ``forecaster`` ("none" where it does without), ``starts``, ``quiet_lt``, ``span_lt``,
    ``delay_lt``, ``strength``, ``noise``, ``metric``, ``value``, ``low``, ``high``. Shown are flows
    that start quietly, of the span that is usual and the quiet that most runs have. ``usual``:
    ``span_lt`` and ``noise`` where nothing else is tried. Returns the figure; one that says why it
    is empty where no share is defined.
    """
    require_single_case(scores)
    runs = where(runs_of(scores, usual["span_lt"]), usual_conditions(usual["noise"]))
    if runs.empty:
        return nothing_to_show("Without control no event occurred that control could prevent.")
    runs = with_kinds(runs, along=False)
    linestyles = linestyles_of(runs)
    comparing = runs["strategy"].isin(COMPARING)
    groups = [rows for rows in (runs[~comparing], runs[comparing]) if not rows.empty]
    kinds = kind_handles(runs, linestyles)
    columns = columns_that_fit(kinds, 3)
    figure = new_figure(DOUBLE_COLUMN, 3.6 + 0.14 * max(0, math.ceil(len(kinds) / columns) - 3))
    panels = list(figure.subplots(1, len(groups), sharey=True, squeeze=False)[0])
    for axes, rows in zip(panels, groups, strict=True):
        _draw_frontier(axes, rows, linestyles)
    colours = [*forecaster_handles(runs), bar_handle("interval over flows")]
    figure.legend(handles=colours, loc="outside upper center", ncols=4)
    figure.legend(handles=kinds, loc="outside lower center", ncols=columns)
    panels[0].set_ylabel(left_label(symbol))
    logarithmic_with_nothing(panels, runs)
    letter_panels(panels)
    return figure


def _draw_frontier(axes: Axes, runs: pd.DataFrame, linestyles: Mapping[str, Any]) -> None:
    """Draw the share left against the time under actuation."""
    for strategy, own in runs.groupby("strategy", sort=False):
        along = strategy_look(str(strategy)).along
        for (kind, forecaster), curve in own.groupby(["kind", "forecaster"], sort=False):
            ordered = curve.sort_values(along or f"value_{ACTING}")
            style = curve_style(str(forecaster), str(strategy), linestyles[str(kind)])
            draw_curve(
                axes, ordered, f"value_{ACTING}", style, xerr=interval_lengths(ordered, ACTING)
            )
        if along is not None:
            # what curves run along is written at one of them
            kinds = list(dict.fromkeys(own["kind"]))
            middle = own[own["kind"] == kinds[len(kinds) // 2]]
            first = forecasters_in_order(middle["forecaster"])[0]
            _label_ends(axes, middle[middle["forecaster"] == first], along)
    axes.set_xscale("log")
    axes.margins(x=0.08)
    low, high = axes.get_xlim()
    steps = (1, 2, 5) if high > 5 * low else (1, 1.5, 2, 3, 4, 5, 7)
    ticks = [step * unit for unit in (0.01, 0.1, 1.0) for step in steps]
    ticks = [tick for tick in ticks if low <= tick <= high]
    # of a narrow range, at least two that are nice between its ends
    axes.xaxis.set_major_locator(FixedLocator(ticks) if len(ticks) > 1 else MaxNLocator(5))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_xlabel("Share of the time under actuation")


def _label_ends(axes: Axes, rows: pd.DataFrame, along: str) -> None:
    """Write at the ends of a curve where along it they are."""
    rows = rows.sort_values(along).iloc[[0, -1]].drop_duplicates(along)
    unit = " LT" if along.endswith("_lt") else ""
    points = zip(rows[f"value_{ACTING}"], rows[f"value_{LEFT}"], rows[along], strict=True)
    for x, y, value in points:
        axes.annotate(
            f"{value:g}{unit}",
            (x, y),
            (4, 3),
            "data",
            "offset points",
            fontsize=6.5,
            color=GREY,
            # legible where a curve passes behind it
            path_effects=[withStroke(linewidth=1.5, foreground="white")],
            zorder=5,
        )
