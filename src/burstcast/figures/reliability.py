"""Reliability diagrams of forecast probabilities, as shares of votes and calibrated on
series other than the test series: observed frequency of events against the mean probability, in
bins. Grey bars: where the frequency would lie, at the level of confidence of the intervals, if the
calibrated probabilities were right. Below: how many calibrated forecasts lie in each bin. Shown are
the forecasters that tell more than two probabilities, if there are any.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from burstcast.base.declared import at, read
from burstcast.figures.parts import alarm_scores, looks, style
from burstcast.figures.registry import figure
from burstcast.forecasters._labels import forecaster_label

FEW_FORECASTS = 10
"""Bins with fewer are open markers without a line: their frequencies are mostly chance."""
_OPEN: dict[str, Any] = {"linestyle": "none", "markerfacecolor": "white", "alpha": 0.6}


@figure(section="probabilities", position=20)
def draw(
    *,
    bins: pd.DataFrame = read("case/tables/reliability.csv"),
    prediction_times_lt: Sequence[float] = at("shown.prediction_times_lt"),
    neurons: float = at("figures.fixed_neurons"),
    validation: str = at("shown.example.name.validation"),
) -> Figure:
    """Draw diagrams, and below them how many forecasts lie in each bin.

    A row for each forecaster with more than two probabilities: yes and no alone are easily
    calibrated. Without any, forecasters with two probabilities are shown. A column for each
    prediction time that the table has, or for its longest.
    """
    bins = alarm_scores.alarms_shown(bins, neurons, validation)
    times = alarm_scores.times_shown(bins, prediction_times_lt)
    shown = np.isclose(bins["prediction_time_lt"].to_numpy()[:, np.newaxis], times).any(axis=1)
    bins = bins[shown & (bins["forecasts"] > 0)]
    by_time = alarm_scores.calibrated(bins).groupby(["forecaster", "prediction_time_lt"])["bin"]
    probabilities = by_time.nunique().groupby("forecaster").max()
    kinds = looks.ordered_forecasters(
        set(probabilities.index[probabilities > 2]) or set(probabilities.index[probabilities > 1])
    )
    if not kinds:
        return style.nothing_to_show("Every forecaster always tells the same probability.")
    width = min(style.DOUBLE_COLUMN, 0.4 + 2.2 * len(times))
    figure = style.new_figure(width, 0.35 + 2.8 * len(kinds))
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
            rows = alarm_scores.calibrated(bins[chosen])
            below, count = counts[row, column], rows["forecasts"]
            below.vlines(rows["mean_probability"], 0.5, count, color=style.GREY, linewidth=3.0)
            below.set_yscale("log")
            below.set_ylim(bottom=0.5)
            title = f"{forecaster_label(kind)}, PT = {time:g} LT"
            diagrams[row, column].set_title(title, loc="center")
        diagrams[row, 0].set_ylabel("Observed frequency")
        counts[row, 0].set_ylabel("Forecasts")
    for axes in counts[-1]:
        axes.set_xticks([0.0, 0.5, 1.0])
        axes.set_xlabel("Probability")
    shown = bins["forecaster"].isin(kinds)
    more = []
    if (shown & (bins["forecasts"] < FEW_FORECASTS)).any():
        label = f"fewer than {FEW_FORECASTS} forecasts"
        more.append(Line2D([], [], label=label, color=style.GREY, marker="o", **_OPEN))
    style.legend_above(figure, diagrams.flat, more, columns=1 if len(times) == 1 else None)
    style.letter_panels(list(diagrams.flat), inside=True)
    return figure


def _draw_diagram(axes: Axes, bins: pd.DataFrame) -> None:
    axes.plot([0, 1], [0, 1], zorder=1, **looks.THRESHOLD)
    for name, look in looks.PROBABILITIES.items():
        rows = bins[bins["probability"] == name].sort_values("mean_probability")
        few = rows["forecasts"] < FEW_FORECASTS
        if not few.all():
            many = rows[~few]
            axes.plot(many["mean_probability"], many["observed_frequency"], label=name, **look)
        if few.any():
            lone = rows[few]
            axes.plot(lone["mean_probability"], lone["observed_frequency"], **{**look, **_OPEN})
    rows = alarm_scores.calibrated(bins)
    axes.vlines(
        rows["mean_probability"],
        rows["consistency_low"],
        rows["consistency_high"],
        color=style.LIGHT_GREY,
        linewidth=4.0,
        zorder=1.5,
        label="consistent with calibration",
    )
    axes.set_xlim(-0.04, 1.04)
    axes.set_ylim(-0.04, 1.04)
