"""Axes of an observable and of time: limits, labels, the event threshold, spans of time."""

import re
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

from burstcast.base.arrays import BoolArray, FloatArray
from burstcast.figures.parts import looks, style

HATCHED: dict[str, Any] = {"facecolor": "none", "edgecolor": style.LIGHT_GREY, "hatch": "//////"}
"""Keywords of a span of time that is hatched."""
SHADED: dict[str, Any] = {"color": style.LIGHT_GREY, "alpha": 0.55, "zorder": 0.5}
"""Keywords of a span of time that is shaded."""
_MARGIN, _NAME = 0.06, 0.2


def axis_floor(*curves: FloatArray) -> float:
    """Lower end of an axis that shows these curves; NaN where there is nothing.

    Zero where the curves are never negative and come near it, or else a margin below them.
    """
    low = min(float(np.nanmin(curve)) for curve in curves)
    high = max(float(np.nanmax(curve)) for curve in curves)
    return 0.0 if 0.0 <= low < high / 4 else low - _MARGIN * (high - low)


def axis_limits(threshold: float, *curves: FloatArray) -> tuple[float, float]:
    """Ends of an axis that shows these curves and the event threshold, with room for its name."""
    floor = axis_floor(*curves, np.array(threshold))
    high = max(float(np.nanmax(curve)) for curve in curves)
    top = max(high + _MARGIN * (high - floor), threshold + _NAME * (max(high, threshold) - floor))
    return floor, top


def true_runs(condition: BoolArray) -> list[tuple[int, int]]:
    """First and last index of each run of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], condition, [False]]).astype(np.int8)))
    return [(int(first), int(last) - 1) for first, last in edges.reshape(-1, 2)]


def observable_label(symbol: str, name: str | None = None) -> str:
    """Label of an axis that shows the observable: "Kinetic energy, $k$", or the symbol alone."""
    upright = re.sub(r"\\mathrm\{(.*)\}", r"\1", symbol).replace(r"\_", "_")
    if name is None or name.lower() == upright.lower():
        return f"${symbol}$"
    name = name.replace("$", r"\$")  # which begins no formula
    return f"{name[:1].upper()}{name[1:]}, ${symbol}$"


def true_and_forecast(symbol: str) -> tuple[str, str]:
    """Labels of the lines of the true observable and of the network's forecast."""
    return rf"${symbol}_{{\mathrm{{True}}}}$", rf"${symbol}_{{\mathrm{{ESN}}}}$"


def draw_threshold(
    axes: Axes, threshold: float, label: str | None = None, *, at_left: bool = False
) -> None:
    """Draw the event threshold as a horizontal line, with its symbol at one of its ends."""
    axes.axhline(threshold, zorder=1.5, **looks.THRESHOLD)
    if label is not None:
        axes.annotate(
            label,
            (0 if at_left else 1, threshold),
            (3 if at_left else -3, 1.5),
            axes.get_yaxis_transform(),
            "offset points",
            ha="left" if at_left else "right",
            va="bottom",
            color=style.GREY,
            # legible where a curve passes behind it
            path_effects=[withStroke(linewidth=2.0, foreground="white")],
            zorder=5,
        )


def density_axes(axes: Axes, threshold: float, symbol: str, name: str) -> None:
    """Label the axes of a density of the observable and mark the event threshold."""
    axes.axvline(threshold, **looks.THRESHOLD)
    axes.annotate(
        f"${symbol}_e$",
        (threshold, 1),
        (2.5, -3),
        axes.get_xaxis_transform(),
        "offset points",
        ha="left",
        va="top",
        color=style.GREY,
    )
    axes.set_yscale("log")
    axes.set_xlabel(observable_label(symbol, name))
    axes.set_ylabel(rf"PDF of ${symbol}$")


def draw_window(axes: Axes, window: tuple[float, float], **span: Any) -> None:
    """Draw the window of a forecast that is classified: a span of time between two lines."""
    axes.axvspan(*window, linewidth=0, **span)
    for edge in window:
        axes.axvline(edge, **looks.WINDOW)


def mark_start(axes: Axes, time_lt: FloatArray, curve: FloatArray) -> None:
    """Draw a point on the curve where a forecast starts, at time 0."""
    value = curve[abs(time_lt).argmin()]
    axes.plot(0, value, "o", color=style.VERMILLION, markersize=4.5, zorder=4)


def draw_span(
    axes: Axes,
    start: float,
    end: float,
    height: float,
    label: str,
    colour: str,
    *,
    to_the_left: bool = False,
) -> None:
    """Draw a double arrow between two times, with its label above it.

    A label wider than its span may begin to the left of it.
    """
    axes.annotate(
        "",
        (end, height),
        (start, height),
        arrowprops={
            "arrowstyle": "<|-|>",
            "color": colour,
            "linewidth": 0.9,
            "shrinkA": 0,
            "shrinkB": 0,
            "mutation_scale": 6,
        },
    )
    axes.annotate(
        label,
        (end if to_the_left else 0.5 * (start + end), height),
        (-2 if to_the_left else 0, 2.5),
        "data",
        "offset points",
        ha="right" if to_the_left else "center",
        va="bottom",
        color=colour,
        # Lines of other parts may pass behind the label.
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.8},
    )
