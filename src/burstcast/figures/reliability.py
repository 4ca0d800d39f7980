"""Reliability: observed frequency of events against the mean forecast probability, in bins. Grey
bars: where the frequency would lie, at the level of confidence of the intervals, if the calibrated
probabilities were right. In the strip above: the logarithm of the number of calibrated forecasts in
each bin. Shown are the forecasters with five distinct probabilities or more, and, where there are
none, those with most.
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
MANY = 5
"""Distinct probabilities of a forecaster that make a diagram."""
_STRIP = 1.06
"""Lower end of the strip of counts, in units of the frequency."""
_OPEN: dict[str, Any] = {"linestyle": "none", "markerfacecolor": "white", "alpha": 0.6}


@figure(section="probabilities", position=20)
def draw(
    *,
    bins: pd.DataFrame = read("case/tables/reliability.csv"),
    prediction_times_lt: Sequence[float] = at("shown.prediction_times_lt"),
    neurons: float = at("figures.fixed_neurons"),
    validation: str = at("shown.example.name.validation"),
) -> Figure:
    """Draw diagrams, with the number of forecasts in each bin.

    A row for each forecaster of `MANY` probabilities, or with most of them. A column for each
    prediction time that the table has, or for its longest.
    """
    bins = alarm_scores.alarms_shown(bins, neurons, validation)
    times = alarm_scores.times_shown(bins, prediction_times_lt)
    shown = np.isclose(bins["prediction_time_lt"].to_numpy()[:, np.newaxis], times).any(axis=1)
    bins = bins[shown & (bins["forecasts"] > 0)]
    by_time = alarm_scores.calibrated(bins).groupby(["forecaster", "prediction_time_lt"])["bin"]
    probabilities = by_time.nunique().groupby("forecaster").max()
    most = min(MANY, probabilities.max()) if len(probabilities) else MANY
    kinds = looks.ordered_forecasters(set(probabilities.index[probabilities >= max(2, most)]))
    if not kinds:
        return style.nothing_to_show("Every forecaster always tells the same probability.")
    width = min(style.DOUBLE_COLUMN, 0.4 + 2.2 * len(times))
    figure = style.new_figure(width, 0.5 + 2.1 * len(kinds))
    diagrams = figure.subplots(len(kinds), len(times), sharex=True, sharey=True, squeeze=False)
    for row, kind in enumerate(kinds):
        for column, time in enumerate(times):
            axes = diagrams[row, column]
            chosen = (bins["forecaster"] == kind) & np.isclose(bins["prediction_time_lt"], time)
            _draw_diagram(axes, bins[chosen])
            _draw_counts(axes, alarm_scores.calibrated(bins[chosen]))
            axes.set_title(f"{forecaster_label(kind)}, PT = {time:g} LT", loc="center")
        diagrams[row, 0].set_ylabel("Observed frequency")
    for axes in diagrams[-1]:
        axes.set_xticks([0.0, 0.5, 1.0])
        axes.set_xlabel("Probability")
    shown = bins["forecaster"].isin(kinds)
    more = []
    if (shown & (bins["forecasts"] < FEW_FORECASTS)).any():
        label = f"fewer than {FEW_FORECASTS} forecasts"
        more.append(Line2D([], [], label=label, color=style.GREY, marker="o", **_OPEN))
    style.legend_above(figure, diagrams.flat, more, columns=1 if len(times) == 1 else None)
    for index, axes in enumerate(diagrams.flat):
        axes.text(0.0, 0.985, f"({chr(ord('a') + index)})", ha="left", va="top")
    return figure


def _draw_counts(axes: Axes, rows: pd.DataFrame) -> None:
    """Draw the logarithm of the number of forecasts in each bin into a strip above the diagram."""
    heights = np.log10(1.0 + rows["forecasts"].to_numpy(dtype=np.float64))
    heights = 0.2 * heights / heights.max(initial=np.log10(2.0))
    axes.axhline(_STRIP, color=style.BLACK, linewidth=0.4)
    axes.vlines(rows["mean_probability"], _STRIP, _STRIP + heights, color=style.GREY, linewidth=2.5)
    label = f"forecasts, {rows['forecasts'].min():g} to {rows['forecasts'].max():g}, log"
    place: Any = {"ha": "center", "va": "top", "fontsize": 6.5, "color": style.GREY}
    axes.text(0.5, _STRIP + 0.23, label, **place)
    axes.set_yticks([0.0, 0.5, 1.0])


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
    axes.set_ylim(-0.04, _STRIP + 0.26)
