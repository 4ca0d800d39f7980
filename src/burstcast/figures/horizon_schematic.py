"""Measurement of the prediction horizon of an extreme event."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from burstcast.base.declared import at
from burstcast.figures.parts import board, style
from burstcast.figures.registry import figure


@figure(section="horizon", position=10)
def draw(
    *,
    longest_lead_time_lt: float = at("horizon.longest_lead_time_lt"),
    lead_time_step_lt: float = at("horizon.lead_time_step_lt"),
    tolerance: float = at("horizon.tolerance"),
    symbol: str = at("case.space.observable_symbol"),
) -> Figure:
    """Draw the procedure that yields PH_ee of one event, with the values in use."""
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.6, layout=None)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    board.clear(axes, 140, 52)
    top, bottom = 37, 11
    first = f"event at $t^{{(e)}}$\n$\\tau_e = {longest_lead_time_lt:g}$ LT"
    start = "washout, then closed loop\nfrom $t^{(e)} - \\tau_e$"
    predicted = "event predicted\n$\\mathrm{PH}_{\\mathrm{ee}} = \\tau_e$"
    missed = "event not predicted\n$\\mathrm{PH}_{\\mathrm{ee}} = $ PH"
    decrease = f"$\\tau_e \\leftarrow \\tau_e - {lead_time_step_lt:g}$ LT"
    for x, y, size, text, colour in (
        (16, top, (27, 15), first, style.BLUE),
        (52, top, (31, 15), start, style.BLUE),
        (124, top, (25, 15), predicted, style.GREEN),
        (124, bottom, (25, 15), missed, style.VERMILLION),
        (52, bottom, (31, 9), decrease, style.BLUE),
    ):
        board.box(axes, x, y, size, text, 1.5, facecolor="white", edgecolor=colour, linewidth=1.1)
    _diamond(axes, 90, top, 29, 21, "PH $\\geq \\tau_e$ ?")
    _diamond(axes, 90, bottom, 29, 17, f"$\\tau_e = {lead_time_step_lt:g}$ LT ?")
    for begin, end in (
        ((29.5, top), (36.5, top)),
        ((67.5, top), (75.5, top)),
        ((104.5, top), (111.5, top)),
        ((90, top - 10.5), (90, bottom + 8.5)),
        ((104.5, bottom), (111.5, bottom)),
        ((75.5, bottom), (67.5, bottom)),
        ((52, bottom + 4.5), (52, top - 7.5)),
    ):
        board.arrow(axes, begin, end, "black", 0.9)
    for left, y, answer in ((107.6, top, "yes"), (107.6, bottom, "yes"), (71.5, bottom, "no")):
        axes.text(left, y + 1, answer, ha="center", va="bottom")
    axes.text(91, 23, "no", ha="left", va="center")
    error = rf"$|{symbol}_{{\mathrm{{ESN}}}} - {symbol}_{{\mathrm{{True}}}}| \;/\; "
    error += rf"({symbol}_e - \overline{{{symbol}}}) < {tolerance:g}$"
    axes.text(2.5, bottom, f"PH: the time for which\n{error}", ha="left", va="center")
    return figure


def _diamond(axes: Axes, x: float, y: float, width: float, height: float, text: str) -> None:
    """Draw a decision centred on a point."""
    corners = [(x - width / 2, y), (x, y + height / 2), (x + width / 2, y), (x, y - height / 2)]
    axes.add_patch(Polygon(corners, facecolor="white", edgecolor="black", linewidth=1.1))
    axes.text(x, y, text, ha="center", va="center")
