"""The flow that networks themselves make, in long closed loops, beside the data. (a) Share of the
series, and of the closed loops of the networks of one size, that have not laminarised (nor
diverged, nor come to rest) by a time. (b) Escape rate against reservoir size: escapes after the
first quarter of each run per time unit that the runs are still in the chaotic phase. Where spectra
were computed: (c) Lyapunov exponents of the networks of one size, in closed loops that stay in the
chaotic phase; they have as many exponents as neurons, and arrows show those far below the flow's
own. (d) Kaplan-Yorke dimension against reservoir size. Data with confidence intervals, medians and
quartiles over the networks of an ensemble. In grey: forecasters to compare with.
"""

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, NullFormatter, StrMethodFormatter

from burstcast.base.declared import at, read
from burstcast.figures.parts import looks, medians, style
from burstcast.figures.registry import figure

_APART = 0.16
"""Distance of the markers of one exponent, so that they do not hide each other."""


@figure(section="long_term", position=40, cases="long_term")
def draw(
    *,
    curves: pd.DataFrame = read("case/tables/survival_curve.csv"),
    curve_percentiles: pd.DataFrame = read("case/tables/survival_curve_percentiles.csv"),
    rates: pd.DataFrame = read("case/tables/survival.csv"),
    rate_percentiles: pd.DataFrame = read("case/tables/survival_percentiles.csv"),
    exponents: Sequence[pd.DataFrame] | None = read("spectrum_case/tables/lyapunov_spectrum.csv"),
    exponent_percentiles: Sequence[pd.DataFrame] | None = read(
        "spectrum_case/tables/lyapunov_spectrum_percentiles.csv"
    ),
    dimensions: Sequence[pd.DataFrame] | None = read("spectrum_case/tables/kaplan_yorke.csv"),
    dimension_percentiles: Sequence[pd.DataFrame] | None = read(
        "spectrum_case/tables/kaplan_yorke_percentiles.csv"
    ),
    neurons: int = at("figures.fixed_neurons"),
) -> Figure:
    """Draw survival curves and escape rates, below them the spectrum where it was computed.

    Each quantity has a table with the rows of the forecaster ``data`` and one of percentiles over
    networks; of the spectrum, one of each or none.
    """
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.6 if exponents is None else 4.9)
    panels = figure.subplots(1 if exponents is None else 2, 2, squeeze=False)
    _draw_curves(panels[0, 0], _of_data(curves), curve_percentiles, neurons)
    _draw_rates(panels[0, 1], _of_data(rates).iloc[0], rate_percentiles)
    if exponents and exponent_percentiles and dimensions and dimension_percentiles:
        _draw_exponents(panels[1, 0], _of_data(exponents[0]), exponent_percentiles[0], neurons)
        dimension = _of_data(dimensions[0]).iloc[0]
        _draw_by_size(panels[1, 1], dimension, dimension_percentiles[0], "kaplan_yorke_dimension")
        panels[1, 1].margins(y=0.15)
        panels[1, 1].set_ylabel("Kaplan\u2013Yorke dimension")
    bands = medians.spread_handles(panels.flat, color=style.BLUE)
    more = [style.band_handle("interval of the data"), *bands]
    style.legend_above(figure, panels.flat, more, columns=4)
    style.letter_panels(list(panels.flat))
    return figure


def _of_data(table: pd.DataFrame) -> pd.DataFrame:
    return table[table["forecaster"] == "data"]


def _draw_by_size(
    axes: Axes, data: "pd.Series[float]", percentiles: pd.DataFrame, metric: str
) -> None:
    """Draw a metric of networks against their size, beside its value and interval of the data."""
    ends = data[f"{metric}_low"], data[f"{metric}_high"]
    axes.axhspan(*ends, color=style.BLACK, alpha=0.15, linewidth=0)
    axes.axhline(data[metric], **looks.TRUTH)
    networks = medians.select(percentiles, forecaster="esn", metric=metric)
    for validation, look, rows in medians.validations(networks):
        medians.draw(axes, rows, "neurons", look, label=f"ESN, {validation}")
    medians.draw_references(axes, percentiles, metric, "neurons", leave_out=["data"])
    axes.set_xticks(sorted(networks["neurons"].dropna().unique()))
    axes.margins(x=0.1)
    axes.set_xlabel(medians.NEURONS)


def _draw_curves(axes: Axes, data: pd.DataFrame, curves: pd.DataFrame, neurons: int) -> None:
    # a share of zero has no logarithm
    low, middle = (data[name].where(data[name] > 0) for name in ("survival_low", "survival"))
    axes.fill_between(
        data["time"], low, data["survival_high"], color=style.BLACK, alpha=0.15, linewidth=0
    )
    axes.plot(data["time"], middle, label="data", **looks.TRUTH)
    networks = medians.select(curves, forecaster="esn", neurons=neurons)
    for _, look, rows in medians.validations(networks):
        medians.draw(axes, rows, "time", look | {"marker": ""})
    medians.draw_references(axes, curves, "survival", "time", neurons=neurons, leave_out=["data"])
    axes.set_yscale("log")
    if axes.get_ylim()[0] > 0.1:  # less than a decade: numbers at all ticks
        axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axes.yaxis.set_minor_formatter(StrMethodFormatter("{x:g}"))
    else:
        axes.yaxis.set_minor_formatter(NullFormatter())
    axes.margins(x=0)
    axes.set_xlabel("Time [time units]")
    axes.set_ylabel("Share in the chaotic phase")


def _draw_rates(axes: Axes, data: "pd.Series[float]", rates: pd.DataFrame) -> None:
    networks = medians.select(rates, forecaster="esn", metric="escape_rate")
    largest = max(float(data["escape_rate_high"]), float(networks["p75"].max()))
    power = math.floor(math.log10(largest))
    scaled = rates.assign(**{name: rates[name] / 10.0**power for name in ("p25", "p50", "p75")})
    names = ["escape_rate", "escape_rate_low", "escape_rate_high"]
    _draw_by_size(axes, data[names] / 10.0**power, scaled, "escape_rate")
    axes.set_ylim(bottom=0)
    unit = rf"$10^{{{power}}}$ per time unit" if power else "per time unit"
    axes.set_ylabel(f"Escape rate [{unit}]")


def _draw_exponents(axes: Axes, data: pd.DataFrame, exponents: pd.DataFrame, neurons: int) -> None:
    axes.axhline(0, color=style.GREY, linewidth=0.5, zorder=0.5)
    names = [f"lyapunov_exponent{end}" for end in ("", "_low", "_high")]
    axes.errorbar(
        data["number"],
        data[names[0]],
        yerr=medians.lengths(data, *names),
        label="data",
        color=style.BLACK,
        linestyle="none",
        marker="_",
        markersize=8,
        **style.BARS,
    )
    lowest, highest = data[names[0]].min(), data[names[0]].max()
    networks = medians.select(exponents, forecaster="esn", neurons=neurons)
    for index, (_, look, rows) in enumerate(medians.validations(networks), 1):
        look = look | {"linestyle": "none"}
        medians.draw(axes, rows, "number", look, band=False, shift=index * _APART)
    # an exponent that belongs to the reservoir alone is far below the exponents of the flow
    room = 0.15 * (highest - lowest)
    below = networks[networks["p50"] < lowest - room]
    axes.set_ylim(lowest - 2 * room, highest + 1.5 * room)
    for number, median in below.groupby("number")["p50"].median().items():
        axes.annotate(
            f"${median:.2g}$",
            (number, 0),
            (number, 0.16),
            axes.get_xaxis_transform(),
            axes.get_xaxis_transform(),
            arrowprops={"arrowstyle": "->", "color": style.GREY, "linewidth": 0.7},
            ha="center",
            color=style.GREY,
        )
    numbers = np.concatenate([data["number"], networks["number"]])
    axes.set_xlim(numbers.min() - 0.6, numbers.max() + 0.6)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel("Number of the exponent")
    axes.set_ylabel("Lyapunov exponent [1 / time unit]")
