"""Exceedance of the event threshold that control leaves, as a share of that without control, with
confidence intervals over flows, against the delay and the strength of the actuator and the noise of
the observations, for settings that were tried at several values. The axis is linear in the shaded
strip: a marker on 0 has left nothing, and its bar ends at the bound of the rule of three.
Colours and fillings distinguish forecasters. One network is shown, and the committee of all
networks of its size.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import NullLocator

from burstcast.figures.parts.control_runs import (
    CONDITIONS,
    Condition,
    curve_style,
    draw_curve,
    forecaster_handles,
    kind_handles,
    left_label,
    linestyles_of,
    logarithmic_with_nothing,
    of_network,
    runs_of,
    tried_under,
    usual_conditions,
    with_kinds,
)
from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast.figures.parts.percentile_curves import require_single_case
from burstcast.figures.parts.style import (
    DOUBLE_COLUMN,
    bar_handle,
    letter_panels,
    new_figure,
    styled,
)
from burstcast.figures.registry import Declaration

FIGURE = Declaration(
    section="control",
    position=60,
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
    """Draw strategies that were tried under several conditions, with one network at most.

    ``span_lt``, ``noise``: Usual length of a run and noise of the observations.
    """
    usual = {"span_lt": span_lt, "noise": noise}
    return control_conditions(of_network(scores, network), usual, symbol=symbol)


@styled
def control_conditions(
    scores: pd.DataFrame, usual: Mapping[str, float], *, symbol: str = "k"
) -> Figure:
    """Draw the share of the exceedance that is left against each condition that varies.

    That is the delay and the strength of the actuator and the noise of the observations, for those
    settings of strategies that were tried at several values. Bars and axes are as in
    `burstcast.figures.control_frontier`.

    ``scores``: A row for each run of control and metric (``relative_exceedance``,
    ``control_fraction``), of one case and one network at most: ``strategy``, its settings,
    ``forecaster`` ("none" where it does without), ``starts``, ``quiet_lt``, ``span_lt``,
    ``delay_lt``, ``strength``, ``noise``, ``metric``, ``value``, ``low``, ``high``. Shown are flows
    that start quietly, of the span that is usual and the quiet that most runs have. ``usual``:
    ``span_lt`` and ``noise`` where nothing else is tried. Returns the figure; one that says why it
    is empty where no condition varies.
    """
    require_single_case(scores)
    runs = runs_of(scores, usual["span_lt"])
    conditions = usual_conditions(usual["noise"])
    tried = {
        condition: found
        for condition in CONDITIONS
        if not (found := tried_under(runs, conditions, condition.column)).empty
    }
    if not tried:
        return nothing_to_show("No strategy was tried under several conditions.")
    figure = new_figure(DOUBLE_COLUMN, 3.0)
    panels = list(figure.subplots(1, len(tried), sharey=True, squeeze=False)[0])
    handles = _draw_conditions(panels, tried)
    colours = forecaster_handles(pd.concat(tried.values()))
    colours.append(bar_handle("interval over flows"))
    figure.legend(handles=colours, loc="outside upper center", ncols=4)
    figure.legend(handles=handles, loc="outside lower center", ncols=3)
    panels[0].set_ylabel(left_label(symbol))
    logarithmic_with_nothing(panels, runs)
    letter_panels(panels)
    return figure


def _draw_conditions(
    panels: Sequence[Axes], tried: Mapping[Condition, pd.DataFrame]
) -> list[Line2D]:
    """Draw the share left against each condition; returns what tells curves apart."""
    together = with_kinds(pd.concat(tried, names=["condition"]), along=True)
    linestyles = linestyles_of(together)
    for axes, condition in zip(panels, tried, strict=True):
        runs = together.loc[[condition]].sort_values(condition.column, kind="stable")
        values = condition.unit * np.unique(runs[condition.column].to_numpy(dtype=np.float64))
        curves = runs.groupby(["kind", "forecaster", "strategy"], sort=False)
        for number, ((kind, forecaster, strategy), rows) in enumerate(curves):
            style = curve_style(str(forecaster), str(strategy), linestyles[str(kind)])
            position = condition.unit * rows[condition.column].to_numpy(dtype=np.float64)
            # a hair apart, so that bars do not hide each other
            share = 0.01 * (number - (len(curves) - 1) / 2)
            if condition.logarithmic:
                position = position * (values[-1] / values[0]) ** share
            else:
                position = position + share * (values[-1] - values[0])
            draw_curve(axes, rows.assign(shown=position), "shown", style)
        if condition.logarithmic:
            axes.set_xscale("log")
        axes.set_xticks(values, [f"{value:g}" for value in values])
        axes.xaxis.set_minor_locator(NullLocator())
        axes.margins(x=0.08)
        axes.set_xlabel(condition.label)
    return kind_handles(together, linestyles)
