"""The prediction horizon of extreme events as a block diagram."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch, Polygon

from burstcast.figures.parts.style import BLUE, DOUBLE_COLUMN, GREEN, VERMILLION, new_figure, styled


@styled
def horizon_schematic(
    *, longest_lead_time_lt: float, lead_time_step_lt: float, tolerance: float, symbol: str = "k"
) -> Figure:
    """Draw the procedure that yields PH_ee of one event, with the values in use.

    Parameters
    ----------
    longest_lead_time_lt, lead_time_step_lt
        First tau_e, and by how much it decreases.
    tolerance
        Of the normalised error.
    symbol
        Of the observable.
    """
    figure = new_figure(DOUBLE_COLUMN, 2.3, layout=None)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_xlim(0, 140)
    axes.set_ylim(0, 46)
    axes.set_aspect("equal")
    axes.set_axis_off()

    _box(
        axes, 16, 30, 27, 15, f"event at $t^{{(e)}}$\n$\\tau_e = {longest_lead_time_lt:g}$ LT", BLUE
    )
    _box(
        axes,
        52,
        30,
        31,
        15,
        "washout, then closed loop\nfrom $t^{(e)} - \\tau_e$",
        BLUE,
    )
    _diamond(axes, 90, 30, 29, 21, "PH $> \\tau_e$ ?")
    _box(axes, 124, 30, 25, 15, "event predicted\n$\\mathrm{PH}_{\\mathrm{ee}} = \\tau_e$", GREEN)
    decrease = f"$\\tau_e \\leftarrow \\tau_e - {lead_time_step_lt:g}$ LT"
    _box(axes, 71, 7.5, 31, 9, decrease, VERMILLION)
    _arrow(axes, (29.5, 30), (36.5, 30))
    _arrow(axes, (67.5, 30), (75.5, 30))
    _arrow(axes, (104.5, 30), (111.5, 30))
    axes.text(107.6, 31, "yes", ha="center", va="bottom")
    axes.plot([90, 90], [19.5, 7.5], color="black", linewidth=0.9)
    _arrow(axes, (90, 7.5), (86.5, 7.5))
    axes.text(91, 14, "no", ha="left", va="center")
    axes.plot([55.5, 52], [7.5, 7.5], color="black", linewidth=0.9)
    _arrow(axes, (52, 7.5), (52, 22.5))
    axes.text(
        97,
        7.5,
        "PH: the time for which\n"
        + rf"$|{symbol}_{{\mathrm{{ESN}}}} - {symbol}_{{\mathrm{{True}}}}| \;/\; "
        + rf"({symbol}_e - \overline{{{symbol}}}) < {tolerance:g}$",
        ha="left",
        va="center",
    )
    return figure


def _box(
    axes: Axes, x: float, y: float, width: float, height: float, text: str, colour: str
) -> None:
    """Draw a box centred on a point."""
    axes.add_patch(
        FancyBboxPatch(
            (x - width / 2, y - height / 2),
            width,
            height,
            boxstyle="round,pad=0,rounding_size=1.5",
            facecolor="white",
            edgecolor=colour,
            linewidth=1.1,
        )
    )
    axes.text(x, y, text, ha="center", va="center", linespacing=1.5)


def _diamond(axes: Axes, x: float, y: float, width: float, height: float, text: str) -> None:
    """Draw a decision centred on a point."""
    corners = [(x - width / 2, y), (x, y + height / 2), (x + width / 2, y), (x, y - height / 2)]
    axes.add_patch(Polygon(corners, facecolor="white", edgecolor="black", linewidth=1.1))
    axes.text(x, y, text, ha="center", va="center")


def _arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Draw an arrow between two points."""
    axes.annotate(
        "",
        end,
        start,
        arrowprops={
            "arrowstyle": "-|>",
            "color": "black",
            "linewidth": 0.9,
            "shrinkA": 0,
            "shrinkB": 0,
            "mutation_scale": 8,
        },
    )
