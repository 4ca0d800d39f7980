"""Placeholder for a figure whose content did not occur in a campaign."""

from matplotlib.figure import Figure

from burstcast.figures.parts.style import GREY, SINGLE_COLUMN, new_figure, styled


@styled
def nothing_to_show(reason: str) -> Figure:
    """Draw a placeholder that states why a figure has no content."""
    figure = new_figure(SINGLE_COLUMN, 0.8, layout=None)
    figure.text(0.5, 0.5, reason, ha="center", va="center", color=GREY)
    return figure
