"""The table of looks: colour, line, marker, filling and order of all that figures tell apart."""

from collections.abc import Iterable, Iterator, Mapping
from itertools import cycle
from typing import Any, TypedDict, TypeVar

import matplotlib
import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.figures.parts.style import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILLION
from burstcast.forecasters._labels import forecaster_label

Dashes = str | tuple[float, tuple[float, ...]]
Curve = TypeVar("Curve")

_DOTS, _DASHES, _LONG = (0.0, (1.0, 1.2)), (0.0, (4.0, 1.5)), (0.0, (8.0, 2.0))
_CHAIN, _DASH_DOT = (0.0, (9.0, 2.0, 1.5, 2.0)), (0.0, (6.0, 1.5, 1.0, 1.5))
_MAUVE, _PALE, _SKY = "#8A5A83", "#A0A0A0", "#56B4E9"


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

# Networks in colours; the equations in grey, learnt ones in mauve, and in front of them where they
# do as well: solid or with wide gaps where a filter comes first, dashed where they start from one
# observation; chained where members of an ensemble vote. Classifiers are orange.
_FORECASTERS: dict[str, tuple[str, Dashes]] = {
    "esn_committee": (BLUE, "-"),
    "esn": (VERMILLION, (0.0, (3.5, 1.2))),
    "esn_aware": (GREEN, "-"),
    "esn_aware_committee": (GREEN, _LONG),
    "equations": (GREY, _DOTS),
    "equations_filtered": (GREY, "-"),
    "equations_filtered_committee": (GREY, _CHAIN),
    "equations_noisy": (GREY, _DASHES),
    "quadratic": (_MAUVE, (2.0, (1.5, 4.0))),
    "quadratic_filtered": (_MAUVE, (0.0, (4.0, 4.0))),
    "quadratic_filtered_committee": (_MAUVE, (6.0, (9.0, 2.0, 1.5, 5.5))),
    "quadratic_aware": (PURPLE, _DASHES),
    "quadratic_aware_filtered": (PURPLE, "-"),
    "quadratic_aware_filtered_committee": (PURPLE, _LONG),
    "analogues": (_PALE, _DASHES),
    "analogues_committee": (_PALE, _CHAIN),
    "linear_inverse": (_PALE, _DOTS),
    "precursor": (ORANGE, "-"),
    "esn_direct": (ORANGE, _DASHES),
    "persistence": (_PALE, _LONG),
    "observable_now": (_PALE, _DASH_DOT),
    "climatology": (_PALE, "-"),
    "permanent_alarm": (_PALE, "-"),
    "random": (GREY, _LONG),
}
_BASELINES = ("persistence", "observable_now", "climatology", "permanent_alarm")
MOST_CURVES = 4
"""Curves of a panel at most."""
MOST_LABELLED = 6
"""Curves at most of a panel whose curves have labels at their ends."""


def ordered_forecasters(kinds: Iterable[str]) -> list[str]:
    """Kinds as legends list them; unknown ones last, by name."""
    return _ordered(kinds, _FORECASTERS)


def forecaster_lines(kinds: Iterable[str]) -> dict[str, dict[str, Any]]:
    """Label, colour and line of kinds of forecasters beside networks, in the order of legends.

    A kind without a look of its own has a colour that no other kind has.
    """
    new_lines: Iterator[Dashes] = cycle((_DASHES, _DOTS, _CHAIN, "-"))
    lines: dict[str, dict[str, Any]] = {}
    for kind in ordered_forecasters(kinds):
        color, linestyle = _FORECASTERS.get(kind) or (_SKY, next(new_lines))
        lines[kind] = {"label": forecaster_label(kind), "color": color, "linestyle": linestyle}
    return lines


def by_panel(curves: list[Curve]) -> list[list[Curve]]:
    """Curves, as many at a time as a panel has."""
    return [curves[first : first + MOST_CURVES] for first in range(0, len(curves), MOST_CURVES)]


def families(kinds: Iterable[str]) -> list[tuple[str, list[str]]]:
    """Kinds of forecasters by family, with its name: as many at a time as a panel has curves."""
    members: dict[str, list[str]] = {
        "networks": [],
        "equations": [],
        "learnt equations": [],
        "other forecasters": [],
        "without a forecast": [],
    }
    for kind in ordered_forecasters(kinds):
        if is_baseline(kind):
            members["without a forecast"].append(kind)
        elif kind.startswith("quadratic"):
            members["learnt equations"].append(kind)
        elif kind.startswith("equations"):
            members["equations"].append(kind)
        elif kind.startswith("esn") and kind != "esn_direct":
            members["networks"].append(kind)
        else:
            members["other forecasters"].append(kind)
    return [(family, some) for family, kinds in members.items() for some in by_panel(kinds)]


def is_baseline(kind: str) -> bool:
    """Whether alarms of a kind come without a forecast."""
    return kind in _BASELINES


_CONTROLLERS = {
    "esn": MarkerStyle(color=BLUE, linestyle="-", linewidth=1.2, marker="o"),
    "equations": MarkerStyle(color=BLACK, linestyle=_DASHES, linewidth=1.2, marker="s"),
    "random": MarkerStyle(color=GREY, linestyle=(0, (1.0, 1.0)), linewidth=1.2, marker="^"),
}
_OTHER_CONTROLLERS = ((PURPLE, "D"), (GREEN, "v"), (ORANGE, "P"), (VERMILLION, "X"), (_SKY, "<"))


def controller_lines(kinds: Iterable[str]) -> dict[str, MarkerStyle]:
    """Lines and markers of kinds of forecasters that trigger the paper's control."""
    others = cycle(_OTHER_CONTROLLERS)
    lines = {}
    for kind in kinds:
        if kind in _CONTROLLERS:
            lines[kind] = _CONTROLLERS[kind]
        else:
            colour, marker = next(others)
            lines[kind] = MarkerStyle(color=colour, linestyle="-", linewidth=1.2, marker=marker)
    return lines


# -- strategies of control -------------------------------------------------------------------------

_STRATEGIES = {
    "receding_horizon": ("receding horizon", "o"),
    "prediction_triggered": ("the paper's strategy", "s"),
    "reactive": ("reactive", "^"),
    "planned": ("planned", "v"),
    "uncontrolled": ("no control", "D"),
}
COMPARING = ("receding_horizon", "planned")
"""Strategies that compare forecasts with and without actuation."""


def strategy(name: str) -> tuple[str, str]:
    """Title and marker of a strategy, known or not."""
    return _STRATEGIES.get(name, (name.replace("_", " "), "D"))


def ordered_strategies(names: Iterable[str]) -> list[str]:
    """Strategies as legends list them; unknown ones last, by name."""
    return _ordered(names, _STRATEGIES)


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


def few_of(values: FloatArray) -> FloatArray:
    """Smallest and largest of sorted values, and some between them: as many as a panel shows."""
    places = np.linspace(0, len(values) - 1, min(len(values), MOST_CURVES))
    some: FloatArray = values[places.round().astype(int)]
    return some


def categories(count: int) -> list[MarkerStyle]:
    """Looks of curves of one panel that have no order: colours, lines and markers differ."""
    dashes: tuple[Dashes, ...] = ("-", _DASHES, _DASH_DOT, _DOTS, _LONG, _CHAIN)
    colours = (BLUE, VERMILLION, GREEN, _MAUVE, ORANGE, BLACK)
    return [
        MarkerStyle(color=colour, linestyle=linestyle, linewidth=1.1, marker=marker)
        for colour, linestyle, marker in zip(colours, dashes, _MARKERS, strict=False)
    ][:count]


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


def _ordered(names: Iterable[str], first: Mapping[str, object]) -> list[str]:
    by_name = sorted(set(names))
    return sorted(by_name, key=[*first, *by_name].index)
