"""Exceedance of the event threshold that control leaves, as a share of that without control, with
confidence intervals over flows: (a) against the share of the time under actuation, along the
horizon, the prediction time, the level or the probability of actuation that is written at the ends
of some curves; "every" is the interval between decisions. The other panels: against the delay and
the strength of the actuator and the noise of the observations, for settings that were tried at
several values. The axis is linear in the shaded strip: a marker on 0 has left nothing, and its bar
ends at the bound of the rule of three.
Colours and fillings distinguish forecasters. One network is shown, and the committee of all
networks of its size.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure, FigureBase
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.ticker import (
    FixedLocator,
    FuncFormatter,
    MaxNLocator,
    NullFormatter,
    NullLocator,
)

from burstcast.arrays import FloatArray
from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast.figures.parts.percentile_curves import require_single_case
from burstcast.figures.parts.reference_forecasters import forecaster_label
from burstcast.figures.parts.style import (
    BLACK,
    BLUE,
    DOUBLE_COLUMN,
    GREEN,
    GREY,
    LIGHT_GREY,
    ORANGE,
    PURPLE,
    VERMILLION,
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

_LEFT, _ACTING = "relative_exceedance", "control_fraction"
_RESULTS = [f"{name}_{metric}" for metric in (_LEFT, _ACTING) for name in ("value", "low", "high")]
_IDENTITY = ["case", "reynolds", "forecaster", "neurons", "validation", "seed", "strategy"]
_DASHES: tuple[Any, ...] = ("-", (0, (4.0, 1.5)), (0, (1.0, 1.0)), (0, (6.0, 1.2, 1.2, 1.2)))


@dataclass(frozen=True)
class _Strategy:
    """Look of a strategy, and the setting along which a curve runs; colours where none looks."""

    title: str
    along: str | None = None
    told: str = ""
    marker: str = "D"
    color: str = GREY


_STRATEGIES = {
    "receding_horizon": _Strategy("receding horizon", "horizon_lt", "{} LT", "o"),
    "prediction_triggered": _Strategy(
        "the paper's strategy", "prediction_time_lt", "{} LT ahead", "s"
    ),
    "reactive": _Strategy("reactive", "level", "{symbol} = {}", "^", ORANGE),
    "random_decisions": _Strategy("random", "probability", "{}", "X", GREY),
}
_OTHER_SETTINGS = {
    "decision_interval_lt": "every {} LT",
    "window_lt": "window of {} LT",
    "vote_share": "{} of the votes",
    "options": "{}",
}

# Colours and fillings of forecasters: full, open, half.
_FORECASTERS = {
    "esn": (BLUE, "full"),
    "esn_committee": (BLUE, "bottom"),
    "equations": (BLACK, "none"),
    "equations_noisy": (GREEN, "left"),
    "equations_filtered": (VERMILLION, "bottom"),
    "quadratic_filtered": (PURPLE, "top"),
    "quadratic_filtered_committee": (PURPLE, "left"),
}
_OTHER_FORECASTER = (GREY, "right")


@dataclass(frozen=True)
class _Condition:
    """A condition that strategies are tried under, as an axis."""

    column: str
    label: str
    logarithmic: bool = True
    unit: float = 1.0


_CONDITIONS = (
    _Condition("delay_lt", "Delay of the actuator [LT]", logarithmic=False),
    _Condition("strength", "Strength of the actuator"),
    _Condition("noise", "Noise of the observations [%]", unit=100.0),
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

    Parameters
    ----------
    scores
        Table of one case.
    network
        Key columns of the network; None: no network is shown.
    span_lt, noise
        Usual length of a run and noise of the observations.
    symbol
        Symbol of the observable.
    """
    shown = ~scores["forecaster"].isin(["esn", "esn_committee", "random"])
    if network is not None:
        shown |= (scores[list(network)] == pd.Series(network)).all(axis="columns")
        # of committees, that of the networks of its size and strategy
        size = pd.Series(network)[["neurons", "validation"]]
        alike = (scores[list(size.index)] == size).all(axis="columns")
        shown |= alike & (scores["forecaster"] == "esn_committee")
    return control_frontier(scores[shown], {"span_lt": span_lt, "noise": noise}, symbol=symbol)


@styled
def control_frontier(
    scores: pd.DataFrame, usual: Mapping[str, float], *, symbol: str = "k"
) -> Figure:
    """Draw the share of the exceedance that is left, (a) against the share of time under actuation.

    Further panels show it against the actuator's delay and strength and the noise of what is
    observed, for those settings of strategies that were tried at several values; a panel for each
    condition that varies. Bars are confidence intervals over flows. The vertical axes are
    logarithmic, and linear in the shaded strip at their foot: "nothing left" has a place.

    Parameters
    ----------
    scores
        A row for each run of control and metric (``relative_exceedance``, ``control_fraction``),
        of one case and one network at most: ``strategy``, its settings, ``forecaster`` ("none"
        where it does without), ``starts``, ``quiet_lt``, ``span_lt``, ``delay_lt``, ``strength``,
        ``noise``, ``metric``, ``value``, ``low``, ``high``. Shown are flows that start quietly, of
        the span that is usual and the quiet that most runs have.
    usual
        ``span_lt`` and ``noise`` where nothing else is tried.
    symbol
        Of the observable.

    Returns
    -------
    The figure; one that says why it is empty where no share is defined.

    Raises
    ------
    ValueError
        If the table holds several cases.
    """
    require_single_case(scores)
    runs = _runs(scores, usual["span_lt"])
    conditions = {"delay_lt": 0.0, "strength": 1.0, "noise": usual["noise"]}
    simple = _where(runs, conditions)
    if simple.empty:
        return nothing_to_show("Without control no event occurred that control could prevent.")
    tried = {
        condition: found
        for condition in _CONDITIONS
        if not (found := _tried(runs, conditions, condition.column)).empty
    }
    figure = new_figure(DOUBLE_COLUMN, 5.4 if tried else 3.0)
    upper: FigureBase = figure
    if tried:
        upper, lower = figure.subfigures(2, 1, squeeze=False, height_ratios=(1.3, 1.0))[:, 0]
    frontier, key = upper.subplots(1, 2, width_ratios=(2.2, 1.0))
    panels = [frontier]
    handles = _draw_frontier(frontier, simple, symbol)
    key.set_axis_off()
    shown = pd.concat([simple, *tried.values()])
    key.legend(handles=[*_forecaster_handles(shown), *handles], loc="center left", borderaxespad=0)
    if tried:
        panels += list(lower.subplots(1, len(tried), sharey=True, squeeze=False)[0])
        handles = _draw_conditions(panels[1:], tried, symbol)
        lower.legend(handles=handles, loc="outside lower center", ncols=3)
        panels[1].set_ylabel("Exceedance left")
    frontier.set_ylabel(
        rf"Exceedance left: $P({symbol} \geq {symbol}_e)$" + "\nwith control / without it"
    )
    _logarithmic_with_nothing(panels, runs)
    letter_panels(panels)
    return figure


# -- what is shown ---------------------------------------------------------------------------------


def _runs(scores: pd.DataFrame, span_lt: float) -> pd.DataFrame:
    """A row for each run of the flows that are shown, with both scores."""
    keys = [name for name in scores.columns if name not in ("metric", "value", "low", "high")]
    parts = []
    for metric in (_LEFT, _ACTING):
        rows = scores[scores["metric"] == metric].drop(columns="metric").drop_duplicates(keys)
        new = {name: f"{name}_{metric}" for name in ("value", "low", "high")}
        parts.append(rows.rename(columns=new))
    runs = parts[0].merge(parts[1], on=keys)
    shown = (runs["starts"] == "quiet") & np.isclose(runs["span_lt"], span_lt)
    runs = runs.loc[shown & runs[f"value_{_LEFT}"].notna()]
    return runs.loc[runs["quiet_lt"].isin(runs["quiet_lt"].mode()[-1:])]


def _where(runs: pd.DataFrame, conditions: Mapping[str, float]) -> pd.DataFrame:
    matching = np.ones(len(runs), dtype=bool)
    for name, value in conditions.items():
        matching &= np.isclose(runs[name].astype(np.float64), value)
    return runs.loc[matching]


def _settings(runs: pd.DataFrame) -> list[str]:
    """Names of the settings that any strategy has."""
    known = {*_IDENTITY, *_RESULTS, "starts", "quiet_lt", "span_lt", "kind"}
    known |= {condition.column for condition in _CONDITIONS}
    return [name for name in runs.columns if name not in known]


def _tried(runs: pd.DataFrame, conditions: Mapping[str, float], column: str) -> pd.DataFrame:
    """Runs with several values of one condition and usual values of all others."""
    runs = _where(runs, {name: value for name, value in conditions.items() if name != column})
    who = ["forecaster", "strategy", *_settings(runs)]
    groups = [rows for _, rows in runs.groupby(who, dropna=False) if rows[column].nunique() > 1]
    return pd.concat(groups) if groups else runs.iloc[:0]


def _strategy(name: str) -> _Strategy:
    return _STRATEGIES.get(name, _Strategy(name.replace("_", " ")))


def _with_kinds(runs: pd.DataFrame, symbol: str, *, along: bool) -> pd.DataFrame:
    """Runs in the order of the legend, each with what is written there.

    That is its strategy, and those settings that tell runs of that strategy apart; also the one
    along which curves run, if that is wanted.
    """
    parts = []
    names = sorted(set(runs["strategy"]))
    for name in sorted(names, key=[*_STRATEGIES, *names].index):
        look, own = _strategy(name), runs[runs["strategy"] == name]
        told = [one for one in _settings(own) if own[one].nunique(dropna=False) > 1]
        told = [one for one in told if one != look.along]
        texts = {one: _OTHER_SETTINGS.get(one, one.replace("_", " ") + " {}") for one in told}
        if along and look.along is not None:
            texts = {look.along: look.told, **texts}
        own = own.sort_values(list(texts)) if texts else own
        kinds = [_kind(look, texts, row, symbol) for _, row in own.iterrows()]
        parts.append(own.assign(kind=kinds))
    named: pd.DataFrame = pd.concat(parts)
    return named


def _kind(
    look: _Strategy, texts: Mapping[str, str], row: "pd.Series[Any]", symbol: str
) -> str:  # fmt: skip
    values = [
        text.format(
            row[name] if isinstance(row[name], str) else f"{row[name]:g}", symbol=f"${symbol}$"
        )
        for name, text in texts.items()
        if pd.notna(row[name])
    ]
    return ", ".join([look.title, *values])


# -- drawing ---------------------------------------------------------------------------------------


def _forecasters(names: Iterable[str]) -> list[str]:
    """In the order of their colours; strategies that do without one last."""
    found = sorted(set(names))
    return sorted(found, key=[*_FORECASTERS, *found].index)


def _style(forecaster: str, strategy: str, linestyle: Any) -> dict[str, Any]:
    """Keywords of a curve: colour and filling for the forecaster, marker for the strategy."""
    look = _strategy(strategy)
    color, filling = _FORECASTERS.get(forecaster, _OTHER_FORECASTER)
    if forecaster == "none":
        color, filling = look.color, "full"
    return {
        "color": color,
        "linestyle": linestyle,
        "linewidth": 1.0,
        "marker": look.marker,
        "markersize": 4.0,
        "fillstyle": filling,
        "markerfacecolor": "white" if filling == "none" else color,
        "markerfacecoloralt": "white",
    }


def _forecaster_handles(runs: pd.DataFrame) -> list[Line2D]:
    """Legend of the colours."""
    handles = []
    for name in _forecasters(runs["forecaster"]):
        if name != "none":
            label = "echo state network" if name == "esn" else forecaster_label(name)
            keywords = {**_style(name, "receding_horizon", "-"), "linewidth": 2.0}
            handles.append(Line2D([], [], label=label, **keywords))
    return handles


def _kind_handles(runs: pd.DataFrame, linestyles: Mapping[str, Any]) -> list[Line2D]:
    """Legend of markers and lines, in grey where a colour stands for the forecaster."""
    handles = []
    for kind, rows in runs.groupby("kind", sort=False):
        strategy = str(rows["strategy"].iloc[0])
        keywords = _style("none", strategy, linestyles[str(kind)])
        handles.append(Line2D([], [], label=str(kind), **keywords))
    return handles


def _linestyles(runs: pd.DataFrame) -> dict[str, Any]:
    """A line for each kind of a strategy."""
    found = {}
    for _, own in runs.groupby("strategy", sort=False):
        for number, kind in enumerate(dict.fromkeys(own["kind"])):
            found[str(kind)] = _DASHES[number % len(_DASHES)]
    return found


def _draw_frontier(axes: Axes, runs: pd.DataFrame, symbol: str) -> list[Line2D]:
    """Draw the share left against the time under actuation; returns what tells curves apart."""
    runs = _with_kinds(runs, symbol, along=False)
    linestyles = _linestyles(runs)
    for strategy, own in runs.groupby("strategy", sort=False):
        along = _strategy(str(strategy)).along
        for (kind, forecaster), curve in own.groupby(["kind", "forecaster"], sort=False):
            ordered = curve.sort_values(along or f"value_{_ACTING}")
            style = _style(str(forecaster), str(strategy), linestyles[str(kind)])
            _draw(axes, ordered, f"value_{_ACTING}", style, xerr=_lengths(ordered, _ACTING))
        if along is not None:
            # what curves run along is written at one of them
            kinds = list(dict.fromkeys(own["kind"]))
            middle = own[own["kind"] == kinds[len(kinds) // 2]]
            first = _forecasters(middle["forecaster"])[0]
            _label_ends(axes, middle[middle["forecaster"] == first], along)
    axes.set_xscale("log")
    axes.margins(x=0.08)
    low, high = axes.get_xlim()
    ticks = [tick for tick in (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0) if low <= tick <= high]
    # of a narrow range, at least two that are nice between its ends
    axes.xaxis.set_major_locator(FixedLocator(ticks) if len(ticks) > 1 else MaxNLocator(5))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_xlabel("Share of the time under actuation")
    return _kind_handles(runs, linestyles)


def _label_ends(axes: Axes, rows: pd.DataFrame, along: str) -> None:
    """Write at the ends of a curve where along it they are."""
    rows = rows.sort_values(along).iloc[[0, -1]].drop_duplicates(along)
    unit = " LT" if along.endswith("_lt") else ""
    points = zip(rows[f"value_{_ACTING}"], rows[f"value_{_LEFT}"], rows[along], strict=True)
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


def _lengths(rows: pd.DataFrame, metric: str) -> FloatArray:
    """Lengths of the bars below and above; percentiles of few flows need not hold the value."""
    value, low, high = (
        rows[f"{name}_{metric}"].to_numpy(dtype=np.float64) for name in ("value", "low", "high")
    )
    lengths = np.clip(np.array([value - low, high - value]), 0.0, None)
    return np.where(np.isfinite(lengths), lengths, 0.0)


def _draw(axes: Axes, rows: pd.DataFrame, x: str, style: Mapping[str, Any], **bars: Any) -> None:
    """Draw the share left, with its interval, against a column."""
    keywords = {**style, **bars, "yerr": _lengths(rows, _LEFT)}
    axes.errorbar(
        rows[x], rows[f"value_{_LEFT}"], capsize=1.5, elinewidth=0.5, capthick=0.5, **keywords
    )


def _draw_conditions(
    panels: Sequence[Axes], tried: Mapping[_Condition, pd.DataFrame], symbol: str
) -> list[Line2D]:
    """Draw the share left against each condition; returns what tells curves apart."""
    together = _with_kinds(pd.concat(tried, names=["condition"]), symbol, along=True)
    linestyles = _linestyles(together)
    for axes, condition in zip(panels, tried, strict=True):
        runs = together.loc[[condition]].sort_values(condition.column, kind="stable")
        values = condition.unit * np.unique(runs[condition.column].to_numpy(dtype=np.float64))
        curves = runs.groupby(["kind", "forecaster", "strategy"], sort=False)
        for number, ((kind, forecaster, strategy), rows) in enumerate(curves):
            style = _style(str(forecaster), str(strategy), linestyles[str(kind)])
            position = condition.unit * rows[condition.column].to_numpy(dtype=np.float64)
            # a hair apart, so that bars do not hide each other
            share = 0.01 * (number - (len(curves) - 1) / 2)
            if condition.logarithmic:
                position = position * (values[-1] / values[0]) ** share
            else:
                position = position + share * (values[-1] - values[0])
            _draw(axes, rows.assign(shown=position), "shown", style)
        if condition.logarithmic:
            axes.set_xscale("log")
        axes.set_xticks(values, [f"{value:g}" for value in values])
        axes.xaxis.set_minor_locator(NullLocator())
        axes.margins(x=0.08)
        axes.set_xlabel(condition.label)
    return _kind_handles(together, linestyles)


def _logarithmic_with_nothing(panels: Sequence[Axes], runs: pd.DataFrame) -> None:
    """Make the vertical axes logarithmic down to the least share that is left, linear below it."""
    shares = runs[f"value_{_LEFT}"]
    least = float(shares[shares > 0].min()) if (shares > 0).any() else 0.1
    end = 10.0 ** np.clip(np.floor(np.log10(least)), -5, -1)
    highest = max(1.0, float(shares.max()), float(runs[f"high_{_LEFT}"].max()))
    for axes in panels:
        axes.set_yscale("symlog", linthresh=end, linscale=0.6)
        axes.set_ylim(-0.25 * end, 3.0 * highest)
        axes.axhspan(-0.25 * end, end, color=LIGHT_GREY, alpha=0.5, linewidth=0, zorder=0.2)
        axes.axhline(1.0, color=GREY, linewidth=0.5, zorder=0.5)
