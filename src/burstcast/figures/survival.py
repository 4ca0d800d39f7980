"""(a) Share of the series, and of the long closed loops of the networks of one size, that have not
laminarised (nor diverged, nor come to rest) by a time: data with confidence intervals, medians and
quartiles over the networks of an ensemble. (b) Escape rate against reservoir size: escapes after
the first quarter of each run per time unit that the runs are still in the chaotic phase. In grey:
forecasters to compare with.
"""

import math

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter, StrMethodFormatter

from burstcast.figures.parts.data_and_networks import draw_by_size, two_panels
from burstcast.figures.parts.percentile_curves import draw_percentiles, select
from burstcast.figures.parts.reference_forecasters import draw_references
from burstcast.figures.parts.style import TRUTH, ordered_validations, styled, validation_style
from burstcast.figures.registry import Declaration

FIGURE = Declaration(
    section="long_term",
    position=40,
    inputs={
        "curves": "case/tables/survival_curve.csv",
        "curve_percentiles": "case/tables/survival_curve_percentiles.csv",
        "rates": "case/tables/survival.csv",
        "rate_percentiles": "case/tables/survival_percentiles.csv",
    },
    settings={"neurons": "figures.fixed_neurons"},
    cases="long_term",
)


@styled
def draw(
    curves: pd.DataFrame,
    curve_percentiles: pd.DataFrame,
    rates: pd.DataFrame,
    rate_percentiles: pd.DataFrame,
    neurons: int,
) -> Figure:
    """Draw (a) the survival curves and (b) the escape rate against reservoir size.

    ``curves``: Rows of the forecaster ``data`` of one case: time, survival, survival_low,
    survival_high. ``curve_percentiles``: Percentiles over networks, of the same case: forecaster,
    neurons, validation, time, metric (``survival``), p25, p50, p75. ``rates``: Row of ``data`` of
    the same case: escape_rate, escape_rate_low, escape_rate_high. ``rate_percentiles``: Percentiles
    over networks, of the same case, of the metric ``escape_rate``.
    """
    curve, rate = (table[table["forecaster"] == "data"] for table in (curves, rates))
    return two_panels(
        lambda axes: _draw_curves(axes, curve, curve_percentiles, neurons),
        lambda axes: _draw_rates(axes, rate.iloc[0], rate_percentiles),
        curve_percentiles,
        rate_percentiles,
    )


def _draw_curves(axes: Axes, data: pd.DataFrame, curves: pd.DataFrame, neurons: int) -> None:
    # a share of zero has no logarithm
    low = data["survival_low"].where(data["survival_low"] > 0)
    axes.fill_between(
        data["time"], low, data["survival_high"], color=TRUTH["color"], alpha=0.15, linewidth=0
    )
    axes.plot(data["time"], data["survival"].where(data["survival"] > 0), label="data", **TRUTH)
    networks = select(curves, forecaster="esn", neurons=neurons)
    for validation in ordered_validations(networks["validation"].dropna()):
        style = validation_style(validation).copy()
        style["marker"] = ""
        draw_percentiles(axes, select(networks, validation=validation), "time", style)
    draw_references(axes, curves, "survival", "time", neurons=neurons, leave_out=["data"])
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
    networks = select(rates, forecaster="esn", metric="escape_rate")
    largest = max(float(data["escape_rate_high"]), float(networks["p75"].max()))
    power = math.floor(math.log10(largest))
    scaled = rates.assign(**{name: rates[name] / 10.0**power for name in ("p25", "p50", "p75")})
    names = ["escape_rate", "escape_rate_low", "escape_rate_high"]
    draw_by_size(axes, data[names] / 10.0**power, scaled, "escape_rate")
    axes.set_ylim(bottom=0)
    unit = rf"$10^{{{power}}}$ per time unit" if power else "per time unit"
    axes.set_ylabel(f"Escape rate [{unit}]")
