"""(a) Lyapunov exponents of the data, with confidence intervals, and of the closed loops of the
networks of one size that stay in the chaotic phase, medians and quartiles over the networks of an
ensemble. The networks have as many exponents as neurons; arrows: those beyond the flow's own are
strongly negative. (b) Kaplan-Yorke dimension against reservoir size. In grey: forecasters to
compare with.
"""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from burstcast.figures.parts.data_and_networks import draw_by_size, two_panels
from burstcast.figures.parts.percentile_curves import draw_percentiles, select
from burstcast.figures.parts.style import (
    GREY,
    TRUTH,
    ordered_validations,
    styled,
    validation_style,
)
from burstcast.figures.registry import Declaration

FIGURE = Declaration(
    section="long_term",
    position=50,
    inputs={
        "exponents": "case/tables/lyapunov_spectrum.csv",
        "exponent_percentiles": "case/tables/lyapunov_spectrum_percentiles.csv",
        "dimensions": "case/tables/kaplan_yorke.csv",
        "dimension_percentiles": "case/tables/kaplan_yorke_percentiles.csv",
    },
    settings={"neurons": "figures.fixed_neurons"},
    cases="spectrum",
)

_APART = 0.16
"""Distance of the markers of one exponent, so that they do not hide each other."""


@styled
def draw(
    exponents: pd.DataFrame,
    exponent_percentiles: pd.DataFrame,
    dimensions: pd.DataFrame,
    dimension_percentiles: pd.DataFrame,
    neurons: int,
) -> Figure:
    """Draw (a) the exponents by their number and (b) the dimension against reservoir size.

    ``exponents``: Rows of the forecaster ``data`` of one case: number, lyapunov_exponent,
    lyapunov_exponent_low, lyapunov_exponent_high. ``exponent_percentiles``: Percentiles over
    networks, of the same case: forecaster, neurons, validation, number, metric
    (``lyapunov_exponent``), p25, p50, p75. ``dimensions``: Row of ``data`` of the same case:
    kaplan_yorke_dimension, kaplan_yorke_dimension_low, kaplan_yorke_dimension_high.
    ``dimension_percentiles``: Percentiles over networks, of the same case, of the metric
    ``kaplan_yorke_dimension``.
    """
    of_data, dimension = (table[table["forecaster"] == "data"] for table in (exponents, dimensions))
    return two_panels(
        lambda axes: _draw_exponents(axes, of_data, exponent_percentiles, neurons),
        lambda axes: _draw_dimensions(axes, dimension.iloc[0], dimension_percentiles),
        exponent_percentiles,
        dimension_percentiles,
    )


def _draw_exponents(axes: Axes, data: pd.DataFrame, exponents: pd.DataFrame, neurons: int) -> None:
    axes.axhline(0, color=GREY, linewidth=0.5, zorder=0.5)
    middle = data["lyapunov_exponent"].to_numpy(dtype=np.float64)
    ends = [data[f"lyapunov_exponent_{end}"].to_numpy(dtype=np.float64) for end in ("low", "high")]
    axes.errorbar(
        data["number"],
        middle,
        yerr=np.nan_to_num([middle - ends[0], ends[1] - middle]),
        label="data",
        color=TRUTH["color"],
        linestyle="none",
        marker="_",
        markersize=8,
        capsize=2.0,
        elinewidth=0.8,
        capthick=0.8,
    )
    lowest, highest = middle.min(), middle.max()
    networks = select(exponents, forecaster="esn", neurons=neurons)
    for index, validation in enumerate(ordered_validations(networks["validation"].dropna()), 1):
        rows = select(networks, validation=validation)
        style = validation_style(validation).copy()
        style["linestyle"] = "none"
        draw_percentiles(axes, rows, "number", style, band=False, shift=index * _APART)
    # an exponent that belongs to the reservoir alone is far below the exponents of the flow
    room = 0.15 * (highest - lowest)
    below = networks[networks["p50"] < lowest - room]
    axes.set_ylim(lowest - 2 * room, highest + 1.5 * room)
    for number in sorted(below["number"].unique()):
        median = below.loc[below["number"] == number, "p50"].median()
        axes.annotate(
            f"${median:.2g}$",
            (number, 0),
            (number, 0.16),
            axes.get_xaxis_transform(),
            axes.get_xaxis_transform(),
            arrowprops={"arrowstyle": "->", "color": GREY, "linewidth": 0.7},
            ha="center",
            color=GREY,
        )
    numbers = pd.concat([data["number"], networks["number"]])
    axes.set_xlim(numbers.min() - 0.6, numbers.max() + 0.6)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel("Number of the exponent")
    axes.set_ylabel("Lyapunov exponent [1 / time unit]")


def _draw_dimensions(axes: Axes, data: "pd.Series[float]", dimensions: pd.DataFrame) -> None:
    draw_by_size(axes, data, dimensions, "kaplan_yorke_dimension")
    axes.margins(y=0.15)
    axes.set_ylabel("Kaplan\u2013Yorke dimension")
