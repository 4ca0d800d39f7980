"""Exceedance of the event threshold that control leaves, as a share of that without control, with
confidence intervals over flows. First row, against the share of the time under actuation: rules and
the paper's strategy, beside strategies that compare forecasts with and without actuation; their
horizontal axes differ. Curves run along the horizon, the prediction time or the level, which is
written at the ends of some of them; "every" is the interval between decisions. Second row, for
settings that were tried at several values: against the delay and the strength of the actuator and
the noise of the observations. The vertical axes are linear in the shaded strip: a marker on 0 has
left nothing, and its bar ends at the bound of the rule of three. Colours and fillings distinguish
forecasters. One network is shown, and the committee of all networks of its size.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullFormatter, NullLocator

from burstcast.base.declared import at, read
from burstcast.figures.parts import control_runs, looks, medians, style
from burstcast.figures.parts.control_runs import ACTING, CONDITIONS, LEFT
from burstcast.figures.registry import figure
from burstcast.forecasters._labels import forecaster_label


@figure(section="control", position=50, cases="other_control")
def draw(
    *,
    scores: pd.DataFrame = read("case/tables/control_strategies.csv"),
    network: Mapping[str, Any] | None = at("shown.frontier_network"),
    span_lt: float = at("control.span_lt"),
    noise: float = at("case.training.noise"),
    symbol: str = at("case.space.observable_symbol"),
) -> Figure:
    """Draw all strategies with one network at most, and the forecasters to compare it with.

    ``span_lt``, ``noise``: Usual length of a run and noise of the observations.
    """
    all_runs = control_runs.runs_of(control_runs.of_network(scores, network), span_lt)
    usual = {"delay_lt": 0.0, "strength": 1.0, "noise": noise}
    runs = control_runs.with_kinds(control_runs.where(all_runs, usual), along=False)
    tried = {
        one.column: found
        for one in CONDITIONS
        if not (found := control_runs.tried_under(all_runs, usual, one.column)).empty
    }
    if runs.empty and not tried:
        return style.nothing_to_show(
            "Without control no event occurred that control could prevent."
        )
    kinds, lines = _kinds(runs)
    columns = style.columns_that_fit(kinds, 3)
    height = 3.6 + 0.14 * max(0, math.ceil(len(kinds) / columns) - 3)
    heights = [height] * (not runs.empty) + [2.9] * bool(tried)
    figure = style.new_figure(style.DOUBLE_COLUMN, sum(heights))
    rows: list[Figure | SubFigure] = [figure]
    if len(heights) > 1:
        rows = list(figure.subfigures(2, 1, squeeze=False, height_ratios=heights)[:, 0])
    panels: list[Axes] = []
    if not runs.empty:
        comparing = runs["strategy"].isin(looks.COMPARING)
        groups = [group for group in (runs[~comparing], runs[comparing]) if not group.empty]
        panels += list(rows[0].subplots(1, len(groups), sharey=True, squeeze=False)[0])
        for axes, group in zip(panels, groups, strict=True):
            _draw_frontier(axes, group, lines)
        rows[0].legend(handles=kinds, loc="outside lower center", ncols=columns)
        _finish(panels, runs, symbol)
    if tried:
        below = list(rows[-1].subplots(1, max(2, len(tried)), sharey=True, squeeze=False)[0])
        for unused in below[len(tried) :]:
            unused.remove()
        below = below[: len(tried)]
        kinds = _draw_conditions(below, tried)
        rows[-1].legend(handles=kinds, loc="outside lower center", ncols=3)
        _finish(below, pd.concat(tried.values()), symbol)
        panels += below
    shown = pd.concat([runs, *tried.values()])
    colours = [*_forecasters(shown), style.bar_handle("interval over flows")]
    rows[0].legend(handles=colours, loc="outside upper center", ncols=4)
    style.letter_panels(panels)
    return figure


def _kinds(runs: pd.DataFrame) -> tuple[list[Line2D], dict[str, Any]]:
    """Legend of strategies and their settings, in grey, and the line of each of them."""
    handles, lines = [], {}
    for strategy, own in runs.groupby("strategy", sort=False):
        for number, kind in enumerate(dict.fromkeys(own["kind"])):
            line = looks.STRATEGY_LINES[number % len(looks.STRATEGY_LINES)]
            keywords = looks.controlled_curve("none", str(strategy), line)
            handles.append(Line2D([], [], label=kind, **keywords))
            lines[kind] = line
    return handles, lines


def _forecasters(runs: pd.DataFrame) -> list[Line2D]:
    """Legend of the colours."""
    names = [one for one in looks.ordered_forecasters(runs["forecaster"]) if one != "none"]
    return [
        Line2D(
            [],
            [],
            label="echo state network" if name == "esn" else forecaster_label(name),
            **{**looks.controlled_curve(name, "receding_horizon", "-"), "linewidth": 2.0},
        )
        for name in names
    ]


def _bars(rows: pd.DataFrame, metric: str) -> Any:
    return medians.lengths(rows, *(f"{name}_{metric}" for name in ("value", "low", "high")))


def _draw_curve(axes: Axes, rows: pd.DataFrame, x: Any, look: Mapping[str, Any]) -> None:
    """Draw the share left, with its interval; ``look`` may have bars along x."""
    keywords: dict[str, Any] = {"capsize": 1.5, "elinewidth": 0.5, "capthick": 0.5, **look}
    axes.errorbar(x, rows[f"value_{LEFT}"], yerr=_bars(rows, LEFT), **keywords)


def _draw_frontier(axes: Axes, runs: pd.DataFrame, lines: Mapping[str, Any]) -> None:
    """Draw the share left against the time under actuation."""
    for strategy, own in runs.groupby("strategy", sort=False):
        along = looks.strategy(str(strategy)).along
        for (kind, forecaster), curve in own.groupby(["kind", "forecaster"], sort=False):
            rows = curve.sort_values(along or f"value_{ACTING}")
            look = looks.controlled_curve(str(forecaster), str(strategy), lines[str(kind)])
            _draw_curve(axes, rows, rows[f"value_{ACTING}"], {**look, "xerr": _bars(rows, ACTING)})
        if along is not None:
            # what curves run along is written at one of them
            kinds = list(dict.fromkeys(own["kind"]))
            middle = own[own["kind"] == kinds[len(kinds) // 2]]
            first = looks.ordered_forecasters(middle["forecaster"])[0]
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
            color=style.GREY,
            # legible where a curve passes behind it
            path_effects=[withStroke(linewidth=1.5, foreground="white")],
            zorder=5,
        )


def _draw_conditions(panels: Sequence[Axes], tried: Mapping[str, pd.DataFrame]) -> list[Line2D]:
    """Draw the share left against each condition; returns what tells curves apart."""
    together = control_runs.with_kinds(pd.concat(tried, names=["condition"]), along=True)
    kinds, lines = _kinds(together)
    conditions = [one for one in CONDITIONS if one.column in tried]
    for axes, condition in zip(panels, conditions, strict=True):
        runs = together.loc[[condition.column]].sort_values(condition.column, kind="stable")
        values = condition.unit * np.unique(runs[condition.column].to_numpy(dtype=np.float64))
        curves = runs.groupby(["kind", "forecaster", "strategy"], sort=False)
        for number, ((kind, forecaster, strategy), rows) in enumerate(curves):
            position = condition.unit * rows[condition.column].to_numpy(dtype=np.float64)
            # a hair apart, so that bars do not hide each other
            share = 0.01 * (number - (len(curves) - 1) / 2)
            if condition.logarithmic:
                position = position * (values[-1] / values[0]) ** share
            else:
                position = position + share * (values[-1] - values[0])
            look = looks.controlled_curve(str(forecaster), str(strategy), lines[str(kind)])
            _draw_curve(axes, rows, position, look)
        if condition.logarithmic:
            axes.set_xscale("log")
        axes.set_xticks(values, [f"{value:g}" for value in values])
        axes.xaxis.set_minor_locator(NullLocator())
        axes.margins(x=0.08)
        axes.set_xlabel(condition.label)
    return kinds


def _finish(panels: Sequence[Axes], runs: pd.DataFrame, symbol: str) -> None:
    """Make the vertical axes logarithmic down to the least share that is left, linear below it."""
    shares = runs[f"value_{LEFT}"]
    # a power of ten, not above the least share but for tiny ones
    end = 10.0 ** np.clip(np.floor(np.log10(shares[shares > 0].min())), -5, -1)
    end = 0.1 if np.isnan(end) else end
    highest = max(1.0, float(shares.max()), float(runs[f"high_{LEFT}"].max()))
    for axes in panels:
        axes.set_yscale("symlog", linthresh=end, linscale=0.6)
        axes.set_ylim(-0.25 * end, 3.0 * highest)
        axes.axhspan(-0.25 * end, end, color=style.LIGHT_GREY, alpha=0.5, linewidth=0, zorder=0.2)
        axes.axhline(1.0, color=style.GREY, linewidth=0.5, zorder=0.5)
    left = rf"Exceedance left: $P({symbol} \geq {symbol}_e)$"
    panels[0].set_ylabel(f"{left}\nwith control / without it")
