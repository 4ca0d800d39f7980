"""Double arrows between two times, with a label: the parts of a forecast."""

from matplotlib.axes import Axes


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
