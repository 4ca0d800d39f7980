"""When is a forecast worth it? Strategies of control at their best, under each condition: (a) share
of the uncontrolled exceedance that is left and (b) cost of the actuation. Settings are chosen on
half of the flows: the cheapest that leave no more than the tolerated share (line), or else the
least exceedance. Shown are the other flows, with bootstrap intervals; where nothing is left, the
bar ends at the bound of the rule of three.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from burstcast.control.setting_names import option_words
from burstcast.figures.parts.control_runs import (
    curve_style,
    forecasters_in_order,
    strategies_in_order,
    strategy_look,
)
from burstcast.figures.parts.linear_below import linear_below
from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast.figures.parts.percentile_curves import require_single_case
from burstcast.figures.parts.style import (
    DOUBLE_COLUMN,
    GREY,
    LIGHT_GREY,
    letter_panels,
    new_figure,
    styled,
)
from burstcast.figures.registry import Declaration
from burstcast.forecasters._labels import forecaster_label

FIGURE = Declaration(
    section="control",
    position=70,
    inputs={"choices": "case/tables/control_choices.csv"},
    settings={"tolerance": "control.tolerated_exceedance", "noise": "case.training.noise"},
    cases="chosen_control",
)

_LEFT, _COSTS = "relative_exceedance", ("effort", "control_fraction")
_COST_LABELS = {
    "effort": "Mean length of the actuation's force",
    "control_fraction": "Share of the time under actuation",
}
_ROW = 0.17
"""Height of a row, inches."""


def draw(*, choices: pd.DataFrame, tolerance: float, noise: float) -> Figure:
    """Draw the strategies of one case."""
    return control_choices(choices, tolerance, usual_noise=noise)


@styled
def control_choices(choices: pd.DataFrame, tolerance: float, *, usual_noise: float) -> Figure:
    """Draw what is left, and what it costs, a row for each strategy under each condition.

    Parameters
    ----------
    choices
        Choices of one case: ``forecaster`` ("none" where no forecaster takes part), ``strategy``,
        ``options`` and ``observed`` if any, ``delay_lt``, ``strength``, ``noise``, ``metric``
        (``relative_exceedance``; ``effort``, or else ``control_fraction``), ``value``, ``low``,
        ``high``. Networks that differ by their seeds are shown by their medians.
    tolerance
        Share of the exceedance that settings were chosen to leave at most.
    usual_noise
        Noise of the observations where no other is tried.

    Returns
    -------
    The figure; one that says why it is empty where no share is defined.

    Raises
    ------
    ValueError
        If the table holds several cases.
    """
    require_single_case(choices)
    cost = next(name for name in _COSTS if name in set(choices["metric"]))
    rows = _medians(choices[choices["metric"].isin([_LEFT, cost])], usual_noise)
    if rows.empty:
        return nothing_to_show("Without control no event occurred that control could prevent.")
    conditions = list(dict.fromkeys(rows["condition"]))
    kinds = _ordered_kinds(rows)
    places = _places(rows, conditions, kinds)
    bottom = max(places.values()) + 1.0
    figure = new_figure(DOUBLE_COLUMN, 1.1 + _ROW * bottom)
    left, right = figure.subplots(1, 2, sharey=True)
    for axes, metric in ((left, _LEFT), (right, cost)):
        for record in rows[rows["metric"] == metric].to_dict("records"):
            place = places[record["condition"], record["kind"]]
            _draw_interval(axes, record, place)
    _mark_conditions((left, right), places, conditions)
    left.set_ylim(bottom, -1.0)
    _with_nothing(left, rows[rows["metric"] == _LEFT])
    left.axvline(tolerance, color=GREY, linewidth=0.7, zorder=0.5)
    left.set_xlabel("Exceedance left: with control / without it")
    right.set_xlim(left=0)
    right.xaxis.set_major_locator(MaxNLocator(5))
    right.set_xlabel(_COST_LABELS[cost])
    handles = [
        Line2D([], [], label=label, **_style(record)) for label, record in _legend(rows, kinds)
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=2)
    letter_panels([left, right])
    return figure


def _medians(choices: pd.DataFrame, usual_noise: float) -> pd.DataFrame:
    """A row for each kind of strategy, condition and metric, with what they are called."""
    words = {
        name: choices[name].fillna("") if name in choices else ""
        for name in ("options", "observed")
    }
    named = choices.assign(**words)
    keys = ["forecaster", "strategy", "options", "delay_lt", "strength", "noise", "observed"]
    keys.append("metric")
    found = named.groupby(keys, sort=False)[["value", "low", "high"]].median().reset_index()
    # conditions from the usual ones on: late, weak, noisy
    distance = (found["noise"] - usual_noise).abs()
    found = found.assign(distance=distance).sort_values(
        ["observed", "distance", "strength", "delay_lt"],
        ascending=[True, True, False, True],
        kind="stable",
    )
    records = found.to_dict("records")
    return found.assign(
        condition=[_condition(record, usual_noise) for record in records],
        kind=pd.Series(map(_kind, records), index=found.index, dtype=object),
    ).dropna(subset="value")


def _kind(record: Mapping[Any, Any]) -> tuple[str, str, str]:
    return record["strategy"], record["options"], record["forecaster"]


def _condition(record: Mapping[Any, Any], usual_noise: float) -> str:
    """Name of a condition by its differences from an actuator in time, at full strength."""
    parts = []
    if record["strength"] != 1:
        parts.append(f"strength {record['strength']:g}")
    if record["delay_lt"]:
        parts.append(f"{record['delay_lt']:g} LT late")
    if not np.isclose(record["noise"], usual_noise):
        parts.append(f"{100 * record['noise']:g} % noise")
    if record["observed"]:
        parts.append(f"observed: {record['observed'].replace('_', ' ')}")
    return ",\n".join(parts) or "in time"


def _ordered_kinds(rows: pd.DataFrame) -> list[tuple[str, str, str]]:
    strategies = strategies_in_order(rows["strategy"])
    forecasters = forecasters_in_order(rows["forecaster"])
    return sorted(
        dict.fromkeys(rows["kind"]),
        key=lambda kind: (strategies.index(kind[0]), kind[1], forecasters.index(kind[2])),
    )


def _places(
    rows: pd.DataFrame, conditions: Iterable[str], kinds: Sequence[tuple[str, str, str]]
) -> dict[tuple[str, tuple[str, str, str]], float]:
    """Vertical places: the rows of a condition one below the other, then a gap."""
    places, at = {}, 0.0
    for condition in conditions:
        present = set(rows.loc[rows["condition"] == condition, "kind"])
        for kind in kinds:
            if kind in present:
                places[condition, kind] = at
                at += 1.0
        at += 1.0
    return places


def _legend(
    rows: pd.DataFrame, kinds: Iterable[tuple[str, str, str]]
) -> Iterable[tuple[str, Mapping[Any, Any]]]:
    for kind in kinds:
        strategy, options, forecaster = kind
        name = strategy_look(strategy).title
        if forecaster != "none":  # parameter-aware forecasters are named so
            label = f"{name}: {forecaster_label(forecaster)}"
        else:
            label = ", ".join(filter(None, (name, option_words(options))))
        yield label, rows[rows["kind"] == kind].iloc[0].to_dict()


def _style(record: Mapping[Any, Any]) -> dict[str, Any]:
    style = curve_style(record["forecaster"], record["strategy"], "")
    # a rule that watches something else than the observable
    is_other = record["forecaster"] == "none" and record["options"]
    return style | ({"markerfacecolor": "white"} if is_other else {})


def _draw_interval(axes: Axes, record: Mapping[Any, Any], place: float) -> None:
    value, low, high = (float(record[name]) for name in ("value", "low", "high"))
    lengths = np.clip(np.nan_to_num([[value - low], [high - value]]), 0.0, None)
    axes.errorbar(value, place, xerr=lengths, elinewidth=0.8, capsize=1.5, **_style(record))


def _mark_conditions(
    panels: Sequence[Axes],
    places: Mapping[tuple[str, tuple[str, str, str]], float],
    conditions: Sequence[str],
) -> None:
    """Name each condition at its rows, and shade every second one."""
    middles = []
    for number, condition in enumerate(conditions):
        own = [place for (name, _), place in places.items() if name == condition]
        middles.append((min(own) + max(own)) / 2)
        if number % 2 == 0:
            for axes in panels:
                axes.axhspan(min(own) - 1, max(own) + 1, color=LIGHT_GREY, alpha=0.35, zorder=0)
    panels[0].set_yticks(middles, conditions)
    panels[0].tick_params(axis="y", length=0)
    panels[1].tick_params(axis="y", length=0)


def _with_nothing(axes: Axes, rows: pd.DataFrame) -> None:
    """Make the horizontal axis logarithmic, and linear near zero: "nothing left" has a place."""
    end = linear_below(rows["value"], -4)
    axes.set_xscale("symlog", linthresh=end, linscale=0.6)
    axes.set_xlim(-0.25 * end, 1.5 * max(1.0, float(rows["high"].max())))
