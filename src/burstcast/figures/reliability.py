"""Reliability diagrams of forecast probabilities, as shares of votes and calibrated on
series other than the test series: observed frequency of events against the mean probability, in
bins. Grey bars: where the frequency would lie, at the level of confidence of the intervals, if the
calibrated probabilities were right. Open markers: fewer than ten forecasts. Below: how many
calibrated forecasts lie in each bin. Shown are the forecasters that tell more than two
probabilities, if there are any.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from burstcast.figures.parts.alarm_scores import alarms_shown, calibrated, times_shown
from burstcast.figures.parts.nothing_to_show import nothing_to_show
from burstcast.figures.parts.percentile_curves import require_single_case
from burstcast.figures.parts.reference_forecasters import ordered_forecasters
from burstcast.figures.parts.style import (
    BLUE,
    DOUBLE_COLUMN,
    GREY,
    LIGHT_GREY,
    ORANGE,
    THRESHOLD,
    MarkerStyle,
    legend_above,
    letter_panels,
    new_figure,
    styled,
)
from burstcast.figures.registry import Declaration
from burstcast.forecasters._labels import forecaster_label

FIGURE = Declaration(
    section="probabilities",
    position=20,
    inputs={"bins": "case/tables/reliability.csv"},
    settings={
        "prediction_times_lt": "figures.reynolds_prediction_times_lt",
        "neurons": "figures.fixed_neurons",
        "validation": "shown.validation",
    },
)

# calibrated last: what is consistent is shown for them
_LOOKS = {
    "votes": ("votes", MarkerStyle(color=ORANGE, linestyle="--", linewidth=0.8, marker="s")),
    "calibrated": ("calibrated", MarkerStyle(color=BLUE, linestyle="-", linewidth=1.1, marker="o")),
}


@styled
def draw(
    bins: pd.DataFrame, prediction_times_lt: Sequence[float], neurons: float, validation: str
) -> Figure:
    """Draw diagrams, and below them how many forecasts lie in each bin.

    A row for each forecaster with more than two probabilities: yes and no alone are easily
    calibrated. Without any, forecasters with two probabilities are shown.

    ``bins``: Bins of one case: forecaster, neurons, validation, probability ("calibrated",
    "votes"), prediction_time_lt, bin, forecasts, mean_probability, observed_frequency,
    consistency_low, consistency_high. ``prediction_times_lt``: Prediction times of the columns; the
    longest in the table where the table has none of them. ``neurons``, ``validation``: Size and
    validation strategy of the networks that are shown; see
    `burstcast.figures.parts.alarm_scores.alarms_shown`.
    """
    require_single_case(bins)
    bins = alarms_shown(bins, neurons, validation)
    times = times_shown(bins, prediction_times_lt)
    shown = np.isclose(bins["prediction_time_lt"].to_numpy()[:, np.newaxis], times).any(axis=1)
    bins = bins[shown & (bins["forecasts"] > 0)]
    by_time = calibrated(bins).groupby(["forecaster", "prediction_time_lt"])["bin"].nunique()
    told = by_time.groupby("forecaster").max()
    kinds = ordered_forecasters(set(told.index[told > 2]) or set(told.index[told > 1]))
    if not kinds:
        return nothing_to_show("Every forecaster always tells the same probability.")
    figure = new_figure(min(DOUBLE_COLUMN, 0.4 + 2.2 * len(times)), 0.35 + 2.8 * len(kinds))
    panels = figure.subplots(
        2 * len(kinds),
        len(times),
        sharex=True,
        sharey="row",
        squeeze=False,
        height_ratios=[3, 1] * len(kinds),
    )
    diagrams, counts = panels[::2], panels[1::2]
    for row, kind in enumerate(kinds):
        for column, time in enumerate(times):
            chosen = (bins["forecaster"] == kind) & np.isclose(bins["prediction_time_lt"], time)
            _draw_diagram(diagrams[row, column], bins[chosen])
            _draw_counts(counts[row, column], bins[chosen])
            title = f"{forecaster_label(kind)}, PT = {time:g} LT"
            diagrams[row, column].set_title(title, loc="center")
        diagrams[row, 0].set_ylabel("Observed frequency")
        counts[row, 0].set_ylabel("Forecasts")
    for axes in counts[-1]:
        axes.set_xticks([0.0, 0.5, 1.0])
        axes.set_xlabel("Probability")
    legend_above(figure, diagrams.flat, columns=1 if len(times) == 1 else None)
    letter_panels(list(diagrams.flat), inside=True)
    return figure


FEW_FORECASTS = 10
"""Bins with fewer are open markers without a line: their frequencies are mostly chance."""


def _draw_diagram(axes: Axes, bins: pd.DataFrame) -> None:
    axes.plot([0, 1], [0, 1], zorder=1, **THRESHOLD)
    for name, (label, style) in _LOOKS.items():
        rows = bins[bins["probability"] == name].sort_values("mean_probability")
        many = rows[rows["forecasts"] >= FEW_FORECASTS]
        few = rows[rows["forecasts"] < FEW_FORECASTS]
        if not many.empty:
            axes.plot(many["mean_probability"], many["observed_frequency"], label=label, **style)
        lone: dict[str, Any] = {
            **style,
            "linestyle": "none",
            "markerfacecolor": "white",
            "alpha": 0.6,
        }
        axes.plot(few["mean_probability"], few["observed_frequency"], **lone)
    axes.vlines(
        rows["mean_probability"],
        rows["consistency_low"],
        rows["consistency_high"],
        color=LIGHT_GREY,
        linewidth=4.0,
        zorder=1.5,
        label="consistent with calibration",
    )
    axes.set_xlim(-0.04, 1.04)
    axes.set_ylim(-0.04, 1.04)


def _draw_counts(axes: Axes, bins: pd.DataFrame) -> None:
    rows = calibrated(bins)
    axes.vlines(rows["mean_probability"], 0.5, rows["forecasts"], color=GREY, linewidth=3.0)
    axes.set_yscale("log")
    axes.set_ylim(bottom=0.5)
