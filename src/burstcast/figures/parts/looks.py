"""The table of looks: colour, line, marker, filling and order of all that figures tell apart."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, TypedDict

import matplotlib
import numpy as np

from burstcast.figures.parts.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    VERMILLION,
)
from burstcast.forecasters._labels import forecaster_label

Dashes = str | tuple[float, tuple[float, ...]]

_DOTS, _DASHES, _LONG = (0.0, (1.0, 1.2)), (0.0, (4.0, 1.5)), (0.0, (8.0, 2.0))
_CHAIN, _DASH_DOT = (0.0, (9.0, 2.0, 1.5, 2.0)), (0.0, (6.0, 1.5, 1.0, 1.5))
_MAUVE, _PALE = "#8A5A83", "#A0A0A0"


class LineStyle(TypedDict):
    """Keywords of a line."""

    color: str
    linestyle: Dashes
    linewidth: float


class MarkerStyle(LineStyle):
    """Keywords of a line with markers."""

    marker: str


# -- roles -----------------------------------------------------------------------------------------

TRUTH = LineStyle(color=BLACK, linestyle="-", linewidth=1.1)
NETWORK = LineStyle(color=VERMILLION, linestyle=(0, (3.5, 1.2)), linewidth=1.2)
TRAINING = LineStyle(color=GREEN, linestyle=(0, (1.0, 1.0)), linewidth=1.3)
FLOOR = LineStyle(color=GREY, linestyle=_DASH_DOT, linewidth=0.9)
THRESHOLD = LineStyle(color=GREY, linestyle="-", linewidth=0.7)
WINDOW = LineStyle(color=BLUE, linestyle=(0, (5.0, 2.0)), linewidth=0.9)
CONTROLLED = LineStyle(color=GREEN, linestyle=(0, (6.0, 1.2, 1.2, 1.2)), linewidth=1.3)


# -- kinds of forecasters --------------------------------------------------------------------------


@dataclass(frozen=True)
class Forecaster:
    """Look of a kind of forecaster: beside networks, and where it controls."""

    color: str = GREY
    linestyle: Dashes = _LONG
    control: str = GREY  #: colour where it controls
    filling: str = "right"  #: of its markers where it controls: full, none, or a half
    marker: str = "D"  #: where strategies have no markers of their own
    control_line: Dashes = "-"


# Networks in colours; the equations in grey, learnt ones in mauve, and in front of them where they
# do as well: solid or with wide gaps where a filter comes first, dashed where they start from one
# observation; chained where members of an ensemble vote. Classifiers are orange.
_FORECASTERS = {
    "esn_committee": Forecaster(BLUE, "-", BLUE, "bottom"),
    "esn": Forecaster(VERMILLION, (0.0, (3.5, 1.2)), BLUE, "full", "o"),
    "esn_aware": Forecaster(GREEN, "-", GREEN, "full"),
    "esn_aware_committee": Forecaster(control=GREEN, filling="bottom"),
    "equations": Forecaster(GREY, _DOTS, BLACK, "none", "s", _DASHES),
    "equations_filtered": Forecaster(GREY, "-", VERMILLION, "bottom"),
    "equations_filtered_committee": Forecaster(GREY, _CHAIN),
    "equations_noisy": Forecaster(GREY, _DASHES, GREEN, "left"),
    "quadratic": Forecaster(_MAUVE, (2.0, (1.5, 4.0)), PURPLE, "right"),
    "quadratic_filtered": Forecaster(_MAUVE, (0.0, (4.0, 4.0)), PURPLE, "top"),
    "quadratic_filtered_committee": Forecaster(_MAUVE, (6.0, (9.0, 2.0, 1.5, 5.5)), PURPLE, "left"),
    "quadratic_aware": Forecaster(PURPLE, _DASHES),
    "quadratic_aware_filtered": Forecaster(PURPLE, "-", PURPLE, "full"),
    "quadratic_aware_filtered_committee": Forecaster(control=PURPLE, filling="none"),
    "analogues": Forecaster(_PALE, _DASHES),
    "analogues_committee": Forecaster(_PALE, _CHAIN),
    "linear_inverse": Forecaster(_PALE, _DOTS),
    "precursor": Forecaster(ORANGE, "-", GREEN, "right"),
    "esn_direct": Forecaster(ORANGE, _DASHES, BLUE, "left"),
    "persistence": Forecaster(_PALE, _LONG),
    "observable_now": Forecaster(_PALE, _DASH_DOT),
    "climatology": Forecaster(_PALE, "-"),
    "permanent_alarm": Forecaster(_PALE, "-"),
    "random": Forecaster(marker="^", control_line=(0, (1.0, 1.0))),
}


def ordered_forecasters(kinds: Iterable[str]) -> list[str]:
    """Kinds as legends list them; unknown ones last, by name."""
    return _ordered(kinds, _FORECASTERS)


def forecaster_line(kind: str) -> dict[str, Any]:
    """Label, colour and line of a kind of forecaster beside networks, as keywords of a line."""
    look = _FORECASTERS.get(kind, Forecaster())
    return {"label": forecaster_label(kind), "color": look.color, "linestyle": look.linestyle}


def controller_line(kind: str) -> MarkerStyle:
    """Line and marker of a kind of forecaster that triggers the paper's control."""
    look = _FORECASTERS.get(kind, Forecaster(control=PURPLE))
    return MarkerStyle(
        color=look.control, linestyle=look.control_line, linewidth=1.2, marker=look.marker
    )


# -- strategies of control -------------------------------------------------------------------------


@dataclass(frozen=True)
class Strategy:
    """Look of a strategy of control, and the setting along which its curves run."""

    title: str
    along: str | None = None
    words: str = ""  #: of a value of the setting ``along``
    marker: str = "D"
    color: str = GREY  #: where no forecaster has a colour


_STRATEGIES = {
    "receding_horizon": Strategy("receding horizon", "horizon_lt", "{} LT", "o"),
    "prediction_triggered": Strategy(
        "the paper's strategy", "prediction_time_lt", "{} LT ahead", "s"
    ),
    "reactive": Strategy("reactive", "level", "level {}", "^", ORANGE),
    "planned": Strategy("planned", "horizon_lt", "{} LT"),
}
COMPARING = ("receding_horizon", "planned")
"""Strategies that compare forecasts with and without actuation."""
SETTINGS = {
    "decision_interval_lt": "every {} LT",
    "window_lt": "window of {} LT",
    "vote_share": "{} of the votes",
}
"""Words for settings of strategies by which their curves differ."""
STRATEGY_LINES: tuple[Dashes, ...] = (
    "-",
    _DASHES,
    (0, (1.0, 1.0)),
    (0, (6.0, 1.2, 1.2, 1.2)),
    _LONG,
    (0, (2.5, 1.0)),
    (0, (4.0, 1.0, 1.0, 1.0, 1.0, 1.0)),
)
"""Lines of the settings of a strategy."""


def strategy(name: str) -> Strategy:
    """Look of a strategy, known or not."""
    return _STRATEGIES.get(name, Strategy(name.replace("_", " ")))


def ordered_strategies(names: Iterable[str]) -> list[str]:
    """Strategies as legends list them; unknown ones last, by name."""
    return _ordered(names, _STRATEGIES)


def controlled_curve(forecaster: str, strategy_name: str, linestyle: Any) -> dict[str, Any]:
    """Keywords of a curve: colour and filling of the forecaster, marker of the strategy."""
    own = strategy(strategy_name)
    look = _FORECASTERS.get(forecaster, Forecaster())
    color, filling = (own.color, "full") if forecaster == "none" else (look.control, look.filling)
    return {
        "color": color,
        "linestyle": linestyle,
        "linewidth": 1.0,
        "marker": own.marker,
        "markersize": 4.0,
        "fillstyle": filling,
        "markerfacecolor": "white" if filling == "none" else color,
        "markerfacecoloralt": "white",
    }


# -- validation strategies, families of curves, prediction times -----------------------------------

_VALIDATIONS = {
    "SSV": MarkerStyle(color=ORANGE, linestyle=_DASHES, linewidth=1.2, marker="s"),
    "RV": MarkerStyle(color=BLUE, linestyle="-", linewidth=1.2, marker="o"),
}
_OTHER_VALIDATION = MarkerStyle(color=PURPLE, linestyle=_DASH_DOT, linewidth=1.2, marker="^")
PROBABILITIES = {
    "votes": MarkerStyle(color=ORANGE, linestyle="--", linewidth=0.8, marker="s"),
    "calibrated": MarkerStyle(color=BLUE, linestyle="-", linewidth=1.1, marker="o"),
}
"""Probabilities as shares of votes, and calibrated."""
TIMES: tuple[tuple[str, Dashes], ...] = (
    (BLUE, (0.0, (3.5, 1.2))),
    (VERMILLION, (0.0, (1.0, 1.0))),
    (PURPLE, _DASH_DOT),
)
"""Colours and lines of prediction times, in turn."""
OPEN_MARKERS = ("o", "s", "^", "D", "v", ">", "<")
"""Markers that look different when they are open."""
_MARKERS = ("o", "s", "^", "D", "v", "P", "X", "<", ">")


def validation(name: str) -> MarkerStyle:
    """Look of a validation strategy."""
    return _VALIDATIONS.get(name, _OTHER_VALIDATION)


def ordered_validations(names: Iterable[str]) -> list[str]:
    """Strategies in the order of the paper (SSV before RV), unknown ones after them by name."""
    return _ordered(names, _VALIDATIONS)


def sequence(count: int) -> list[MarkerStyle]:
    """Looks of an ordered family of curves (reservoir sizes): dark to light, markers differ."""
    colours = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.82, max(count, 2)))[:count]
    return [
        MarkerStyle(
            color=matplotlib.colors.to_hex(colour),
            linestyle="-" if index % 2 == 0 else (0, (4.0, 1.2)),
            linewidth=1.0,
            marker=_MARKERS[index % len(_MARKERS)],
        )
        for index, colour in enumerate(colours)
    ]


def _ordered(names: Iterable[str], known: Mapping[str, object]) -> list[str]:
    found = sorted(set(names))
    return sorted(found, key=[*known, *found].index)
