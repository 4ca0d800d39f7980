"""Measurement of the prediction horizon of an extreme event."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch, Polygon

from burstcast.figures.parts.style import BLUE, DOUBLE_COLUMN, GREEN, VERMILLION, new_figure, styled
from burstcast.figures.registry import Declaration

FIGURE = Declaration(
    section="horizon",
    position=10,
    settings={
        "longest_lead_time_lt": "horizon.longest_lead_time_lt",
        "lead_time_step_lt": "horizon.lead_time_step_lt",
        "tolerance": "horizon.tolerance",
        "symbol": "shown.symbol",
    },
)


@styled
def draw(
    *, longest_lead_time_lt: float, lead_time_step_lt: float, tolerance: float, symbol: str = "k"
) -> Figure:
    """Draw the procedure that yields PH_ee of one event, with the values in use."""
    figure = new_figure(DOUBLE_COLUMN, 2.6, layout=None)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_xlim(0, 140)
    axes.set_ylim(0, 52)
    axes.set_aspect("equal")
    axes.set_axis_off()

    top, bottom = 37, 11
    first = f"event at $t^{{(e)}}$\n$\\tau_e = {longest_lead_time_lt:g}$ LT"
    _box(axes, 16, top, 27, 15, first, BLUE)
    _box(axes, 52, top, 31, 15, "washout, then closed loop\nfrom $t^{(e)} - \\tau_e$", BLUE)
    _diamond(axes, 90, top, 29, 21, "PH $\\geq \\tau_e$ ?")
    _box(axes, 124, top, 25, 15, "event predicted\n$\\mathrm{PH}_{\\mathrm{ee}} = \\tau_e$", GREEN)
    shortest = f"$\\tau_e = {lead_time_step_lt:g}$ LT ?"
    _diamond(axes, 90, bottom, 29, 17, shortest)
    missed = "event not predicted\n$\\mathrm{PH}_{\\mathrm{ee}} = $ PH"
    _box(axes, 124, bottom, 25, 15, missed, VERMILLION)
    decrease = f"$\\tau_e \\leftarrow \\tau_e - {lead_time_step_lt:g}$ LT"
    _box(axes, 52, bottom, 31, 9, decrease, BLUE)
    _arrow(axes, (29.5, top), (36.5, top))
    _arrow(axes, (67.5, top), (75.5, top))
    _arrow(axes, (104.5, top), (111.5, top))
    _arrow(axes, (90, top - 10.5), (90, bottom + 8.5))
    _arrow(axes, (104.5, bottom), (111.5, bottom))
    _arrow(axes, (75.5, bottom), (67.5, bottom))
    _arrow(axes, (52, bottom + 4.5), (52, top - 7.5))
    for y in (top, bottom):
        axes.text(107.6, y + 1, "yes", ha="center", va="bottom")
    axes.text(91, 23, "no", ha="left", va="center")
    axes.text(71.5, bottom + 1, "no", ha="center", va="bottom")
    axes.text(
        2.5,
        bottom,
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
