"""A drawing board for schematics: boxes and arrows in units of its own."""

from typing import Any

from matplotlib.axes import Axes
from matplotlib.patches import FancyBboxPatch


def clear(axes: Axes, width: float, height: float) -> None:
    """Make the axes an empty board of a size, with equal units."""
    axes.set_xlim(0, width)
    axes.set_ylim(0, height)
    axes.set_aspect("equal")
    axes.set_axis_off()


def arrow(
    axes: Axes, start: tuple[float, float], end: tuple[float, float], colour: str, width: float
) -> None:
    """Draw an arrow between two points."""
    look: dict[str, Any] = {"arrowstyle": "-|>", "color": colour, "linewidth": width}
    axes.annotate(
        "", end, start, arrowprops={**look, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 8}
    )


def box(
    axes: Axes, x: float, y: float, size: tuple[float, float], text: str, radius: float, **look: Any
) -> None:
    """Draw a rounded box with a text, centred on a point."""
    width, height = size
    shape = f"round,pad=0,rounding_size={radius:g}"
    corner = (x - width / 2, y - height / 2)
    axes.add_patch(FancyBboxPatch(corner, width, height, boxstyle=shape, **look))
    axes.text(x, y, text, ha="center", va="center", linespacing=1.5)
