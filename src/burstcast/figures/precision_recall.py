"""Precision against recall of alarms, at each threshold of the calibrated probability that bins of
the reliability diagram have: the higher the threshold, the smaller the recall. Steps, as the
average precision counts them, begin at the highest threshold. Shown are the six forecasters with
the largest average precision, without the equations from the true state, which are always right.
The grey line is the base rate, the precision of an alarm that is always on.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from burstcast.base.arrays import FloatArray
from burstcast.base.declared import at, read
from burstcast.figures.parts import alarm_scores, looks, style
from burstcast.figures.registry import figure
from burstcast.forecasters._labels import forecaster_label


@figure(section="probabilities", position=25)
def draw(
    *,
    bins: pd.DataFrame = read("case/tables/reliability.csv"),
    prediction_times_lt: Sequence[float] = at("shown.prediction_times_lt"),
    neurons: float = at("figures.fixed_neurons"),
    validation: str = at("shown.example.name.validation"),
) -> Figure:
    """Draw a panel for each prediction time that the table has, or for its longest."""
    bins = alarm_scores.calibrated(alarm_scores.alarms_shown(bins, neurons, validation))
    forecasting = [kind for kind in bins["forecaster"].unique() if not looks.is_baseline(kind)]
    bins = bins[(bins["forecasts"] > 0) & bins["forecaster"].isin({*forecasting} - {"equations"})]
    if bins.empty:
        return style.nothing_to_show("No probability is of a forecast that can be wrong.")
    times = alarm_scores.times_shown(bins, prediction_times_lt)
    # of the networks of an ensemble, the first
    single = ~bins.duplicated(["forecaster", "prediction_time_lt", "bin"])
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.9)
    panels = figure.subplots(1, len(times), sharex=True, sharey=True, squeeze=False)[0]
    for axes, time in zip(panels, times, strict=True):
        shown = bins[single & np.isclose(bins["prediction_time_lt"], time)]
        curves = {str(kind): curve_of(rows) for kind, rows in shown.groupby("forecaster")}
        curves = {kind: curve for kind, curve in curves.items() if len(curve[0])}
        best = sorted(curves, key=lambda kind: -_area(*curves[kind]))[: looks.MOST_LABELLED]
        for kind, look in zip(best, looks.categories(len(best)), strict=True):
            recall, precision = curves[kind]
            steps = np.insert(recall, 0, 0.0), np.insert(precision, 0, precision[0])
            marks: Any = {**look, "markersize": 3.0, "markevery": slice(1, None)}
            axes.plot(*steps, label=forecaster_label(kind), drawstyle="steps-pre", **marks)
        events = (shown["forecasts"] * shown["observed_frequency"]).sum()
        axes.axhline(events / max(1, shown["forecasts"].sum()), label="base rate", **looks.FLOOR)
        axes.set_xlim(-0.02, 1.02)
        axes.set_ylim(0, 1.04)
        axes.set_xlabel("Recall")
        axes.set_title(f"PT = {time:g} LT", loc="center")
    panels[0].set_ylabel("Precision")
    style.legend_above(figure, panels, columns=4)
    style.letter_panels(panels)
    return figure


def curve_of(rows: pd.DataFrame) -> tuple[FloatArray, FloatArray]:
    """Recall and precision with each bin as the lowest that raises an alarm, from the highest.

    Examples
    --------
    >>> import pandas as pd
    >>> names = ["mean_probability", "forecasts", "observed_frequency"]
    >>> bins = pd.DataFrame([(0.1, 90, 0.1), (0.9, 10, 0.9)], columns=names)
    >>> recall, precision = curve_of(bins)
    >>> recall.tolist(), precision.tolist()
    ([0.5, 1.0], [0.9, 0.18])
    """
    rows = rows.sort_values("mean_probability", ascending=False)
    alarms = rows["forecasts"].to_numpy(dtype=np.float64).cumsum()
    hits = (rows["forecasts"] * rows["observed_frequency"]).to_numpy(dtype=np.float64).cumsum()
    if not len(hits) or hits[-1] == 0:
        return np.empty(0), np.empty(0)
    return hits / hits[-1], hits / alarms


def _area(recall: FloatArray, precision: FloatArray) -> float:
    """Average precision: area below the curve in steps."""
    return float((np.diff(recall, prepend=0.0) * precision).sum())
