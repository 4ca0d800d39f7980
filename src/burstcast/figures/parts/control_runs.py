"""Runs of all strategies of control as curves: what is shown, and how each is drawn.

Colours and fillings stand for forecasters, markers for strategies, lines for settings.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from burstcast.arrays import FloatArray
from burstcast.control.setting_names import option_words
from burstcast.figures.parts.linear_below import linear_below
from burstcast.figures.parts.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    LIGHT_GREY,
    ORANGE,
    PURPLE,
    VERMILLION,
)
from burstcast.forecasters._labels import forecaster_label

LEFT, ACTING = "relative_exceedance", "control_fraction"
_RESULTS = [f"{name}_{metric}" for metric in (LEFT, ACTING) for name in ("value", "low", "high")]
_IDENTITY = ["case", "reynolds", "forecaster", "neurons", "validation", "seed", "strategy"]
_DASHES: tuple[Any, ...] = (
    "-",
    (0, (4.0, 1.5)),
    (0, (1.0, 1.0)),
    (0, (6.0, 1.2, 1.2, 1.2)),
    (0, (8.0, 2.0)),
    (0, (2.5, 1.0)),
    (0, (4.0, 1.0, 1.0, 1.0, 1.0, 1.0)),
)


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
    "reactive": _Strategy("reactive", "level", "level {}", "^", ORANGE),
    "planned": _Strategy("planned", "horizon_lt", "{} LT"),
    "random_decisions": _Strategy("random", "probability", "{}", "X", GREY),
}
COMPARING = ("receding_horizon", "planned")
"""Strategies that compare forecasts with and without actuation."""

_OTHER_SETTINGS = {
    "decision_interval_lt": "every {} LT",
    "window_lt": "window of {} LT",
    "vote_share": "{} of the votes",
}

# Colours and fillings of forecasters: full, open, half.
_FORECASTERS = {
    "esn": (BLUE, "full"),
    "esn_committee": (BLUE, "bottom"),
    "esn_aware": (GREEN, "full"),
    "esn_aware_committee": (GREEN, "bottom"),
    "esn_direct": (BLUE, "left"),
    "precursor": (GREEN, "right"),
    "equations": (BLACK, "none"),
    "equations_noisy": (GREEN, "left"),
    "equations_filtered": (VERMILLION, "bottom"),
    "quadratic_filtered": (PURPLE, "top"),
    "quadratic_filtered_committee": (PURPLE, "left"),
    "quadratic": (PURPLE, "right"),
    "quadratic_aware_filtered": (PURPLE, "full"),
    "quadratic_aware_filtered_committee": (PURPLE, "none"),
}
_OTHER_FORECASTER = (GREY, "right")


@dataclass(frozen=True)
class Condition:
    """A condition that strategies are tried under, as an axis."""

    column: str
    label: str
    logarithmic: bool = True
    unit: float = 1.0


CONDITIONS = (
    Condition("delay_lt", "Delay of the actuator [LT]", logarithmic=False),
    Condition("strength", "Strength of the actuator"),
    Condition("noise", "Noise of the observations [%]", unit=100.0),
)


def usual_conditions(noise: float) -> dict[str, float]:
    """Conditions under which strategies are compared: an actuator as it is, and this noise."""
    return {"delay_lt": 0.0, "strength": 1.0, "noise": noise}


def of_network(scores: pd.DataFrame, network: Mapping[str, Any] | None) -> pd.DataFrame:
    """Rows of one network, of the committee of its size, and of all other forecasters."""
    shown = ~scores["forecaster"].isin(["esn", "esn_committee", "random"])
    if network is not None:
        shown |= (scores[list(network)] == pd.Series(network)).all(axis="columns")
        # the committee of the networks of its size and strategy
        size = pd.Series(network)[["neurons", "validation"]]
        alike = (scores[list(size.index)] == size).all(axis="columns")
        shown |= alike & (scores["forecaster"] == "esn_committee")
    return scores[shown]


# -- what is shown ---------------------------------------------------------------------------------


def runs_of(scores: pd.DataFrame, span_lt: float) -> pd.DataFrame:
    """A row for each run of the flows that are shown, with both scores."""
    keys = [name for name in scores.columns if name not in ("metric", "value", "low", "high")]
    parts = []
    for metric in (LEFT, ACTING):
        rows = scores[scores["metric"] == metric].drop(columns="metric").drop_duplicates(keys)
        new = {name: f"{name}_{metric}" for name in ("value", "low", "high")}
        parts.append(rows.rename(columns=new))
    runs = parts[0].merge(parts[1], on=keys)
    shown = (runs["starts"] == "quiet") & np.isclose(runs["span_lt"], span_lt)
    runs = runs.loc[shown & runs[f"value_{LEFT}"].notna()]
    return runs.loc[runs["quiet_lt"].isin(runs["quiet_lt"].mode()[-1:])]


def where(runs: pd.DataFrame, conditions: Mapping[str, float]) -> pd.DataFrame:
    """Runs under these conditions."""
    matching = np.ones(len(runs), dtype=bool)
    for name, value in conditions.items():
        matching &= np.isclose(runs[name].astype(np.float64), value)
    return runs.loc[matching]


def _settings(runs: pd.DataFrame) -> list[str]:
    """Names of the settings that any strategy has."""
    known = {*_IDENTITY, *_RESULTS, "starts", "quiet_lt", "span_lt", "kind"}
    known |= {condition.column for condition in CONDITIONS}
    return [name for name in runs.columns if name not in known]


def tried_under(runs: pd.DataFrame, conditions: Mapping[str, float], column: str) -> pd.DataFrame:
    """Runs with several values of one condition and usual values of all others."""
    runs = where(runs, {name: value for name, value in conditions.items() if name != column})
    who = ["forecaster", "strategy", *_settings(runs)]
    groups = [rows for _, rows in runs.groupby(who, dropna=False) if rows[column].nunique() > 1]
    return pd.concat(groups) if groups else runs.iloc[:0]


def strategy_look(name: str) -> _Strategy:
    """Look of a strategy, known or not."""
    return _STRATEGIES.get(name, _Strategy(name.replace("_", " ")))


def strategies_in_order(names: Iterable[str]) -> list[str]:
    """In the order of legends; strategies without a look of their own last."""
    found = sorted(set(names))
    return sorted(found, key=[*_STRATEGIES, *found].index)


def with_kinds(runs: pd.DataFrame, *, along: bool) -> pd.DataFrame:
    """Runs in the order of the legend, each with what is written there.

    That is its strategy, and those settings that tell runs of that strategy apart; also the one
    along which curves run, if that is wanted.
    """
    parts = []
    for name in strategies_in_order(runs["strategy"]):
        look, own = strategy_look(name), runs[runs["strategy"] == name]
        told = [one for one in _settings(own) if own[one].nunique(dropna=False) > 1]
        told = [one for one in told if one != look.along]
        texts = {one: _OTHER_SETTINGS.get(one, one.replace("_", " ") + " {}") for one in told}
        if along and look.along is not None:
            texts = {look.along: look.told, **texts}
        own = own.sort_values(list(texts)) if texts else own
        kinds = [_kind(look, texts, row) for _, row in own.iterrows()]
        parts.append(own.assign(kind=kinds))
    named: pd.DataFrame = pd.concat(parts)
    return named


def _kind(look: _Strategy, texts: Mapping[str, str], row: "pd.Series[Any]") -> str:
    values = [
        _setting_words(name, row[name], text) for name, text in texts.items() if pd.notna(row[name])
    ]
    return ", ".join([look.title, *filter(None, values)])


def _setting_words(name: str, value: Any, text: str) -> str:
    if name == "options":
        return option_words(value)
    return text.format(value.replace("_", " ") if isinstance(value, str) else f"{value:g}")


# -- drawing ---------------------------------------------------------------------------------------


def forecasters_in_order(names: Iterable[str]) -> list[str]:
    """In the order of their colours; strategies that do without one last."""
    found = sorted(set(names))
    return sorted(found, key=[*_FORECASTERS, *found].index)


def curve_style(forecaster: str, strategy: str, linestyle: Any) -> dict[str, Any]:
    """Keywords of a curve: colour and filling for the forecaster, marker for the strategy."""
    look = strategy_look(strategy)
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


def forecaster_handles(runs: pd.DataFrame) -> list[Line2D]:
    """Legend of the colours."""
    handles = []
    for name in forecasters_in_order(runs["forecaster"]):
        if name != "none":
            label = "echo state network" if name == "esn" else forecaster_label(name)
            keywords = {**curve_style(name, "receding_horizon", "-"), "linewidth": 2.0}
            handles.append(Line2D([], [], label=label, **keywords))
    return handles


def kind_handles(runs: pd.DataFrame, linestyles: Mapping[str, Any]) -> list[Line2D]:
    """Legend of markers and lines, in grey where a colour stands for the forecaster."""
    handles = []
    for kind, rows in runs.groupby("kind", sort=False):
        strategy = str(rows["strategy"].iloc[0])
        keywords = curve_style("none", strategy, linestyles[str(kind)])
        handles.append(Line2D([], [], label=str(kind), **keywords))
    return handles


def linestyles_of(runs: pd.DataFrame) -> dict[str, Any]:
    """A line for each kind of a strategy."""
    found = {}
    for _, own in runs.groupby("strategy", sort=False):
        for number, kind in enumerate(dict.fromkeys(own["kind"])):
            found[str(kind)] = _DASHES[number % len(_DASHES)]
    return found


def interval_lengths(rows: pd.DataFrame, metric: str) -> FloatArray:
    """Lengths of the bars below and above; percentiles of few flows need not hold the value."""
    value, low, high = (
        rows[f"{name}_{metric}"].to_numpy(dtype=np.float64) for name in ("value", "low", "high")
    )
    lengths = np.clip(np.array([value - low, high - value]), 0.0, None)
    return np.where(np.isfinite(lengths), lengths, 0.0)


def draw_curve(
    axes: Axes, rows: pd.DataFrame, x: str, style: Mapping[str, Any], **bars: Any
) -> None:
    """Draw the share left, with its interval, against a column."""
    keywords = {**style, **bars, "yerr": interval_lengths(rows, LEFT)}
    axes.errorbar(
        rows[x], rows[f"value_{LEFT}"], capsize=1.5, elinewidth=0.5, capthick=0.5, **keywords
    )


def left_label(symbol: str) -> str:
    """Label of an axis of the share of the exceedance that is left."""
    return rf"Exceedance left: $P({symbol} \geq {symbol}_e)$" + "\nwith control / without it"


def logarithmic_with_nothing(panels: Sequence[Axes], runs: pd.DataFrame) -> None:
    """Make the vertical axes logarithmic down to the least share that is left, linear below it."""
    shares = runs[f"value_{LEFT}"]
    end = linear_below(shares, -5)
    highest = max(1.0, float(shares.max()), float(runs[f"high_{LEFT}"].max()))
    for axes in panels:
        axes.set_yscale("symlog", linthresh=end, linscale=0.6)
        axes.set_ylim(-0.25 * end, 3.0 * highest)
        axes.axhspan(-0.25 * end, end, color=LIGHT_GREY, alpha=0.5, linewidth=0, zorder=0.2)
        axes.axhline(1.0, color=GREY, linewidth=0.5, zorder=0.5)
