"""(a) F-score of the alarms, whose threshold was chosen on the calibration series, and (b) Brier
skill of the calibrated probabilities, against prediction time: the six sources of alarms with the
largest mean skill, without the equations from the true state, which are right throughout. The grey
band is the climatological forecast, whose alarm is always on. Probabilities of a committee are the
share of its members that forecast an event. Bands: bootstrap intervals over the test series; of a
network, medians over the networks of an ensemble of the scores and of the ends of their intervals.
Skills below -0.1 are cut off.
"""

from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from burstcast.base.declared import at, read
from burstcast.figures.parts import alarm_scores, looks, medians, style
from burstcast.figures.registry import figure
from burstcast.forecasters._labels import forecaster_label

_LABELS = {"alarm_f_score": "F-score of alarms", "brier_skill": "Brier skill score"}
_LIMITS = {"alarm_f_score": (0.0, 1.04), "brier_skill": (-0.1, 1.04)}
_TIME = "prediction_time_lt"
_REFERENCE, _ALWAYS_RIGHT = "climatology", "equations"


@figure(section="probabilities", position=10, cases="every")
def draw(
    *,
    scores: pd.DataFrame = read("case/tables/probability_scores.csv"),
    neurons: float = at("figures.fixed_neurons"),
    validation: str = at("shown.example.name.validation"),
) -> Figure:
    """Draw the F-score of alarms and the Brier skill against the prediction time."""
    scores = alarm_scores.alarms_shown(alarm_scores.calibrated(scores), neurons, validation)
    curves = {
        metric: alarm_scores.median_networks(scores[scores["metric"] == metric], _TIME).dropna(
            subset="value"
        )
        for metric in _LABELS
    }
    kinds = _most_skilful(curves["brier_skill"])
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.7)
    panels = figure.subplots(1, 2, sharex=True)
    for axes, (metric, label) in zip(panels, _LABELS.items(), strict=True):
        rows = curves[metric]
        _draw_band(axes, rows[rows["forecaster"] == _REFERENCE], style.LIGHT_GREY, 0.9)
        for kind, look in zip(kinds, looks.categories(len(kinds)), strict=True):
            _draw_curve(axes, rows[rows["forecaster"] == kind], look, kind)
        axes.set_ylabel(label)
        axes.set_ylim(_LIMITS[metric])
        axes.margins(x=0.02)
        axes.xaxis.set_major_locator(MultipleLocator(1))
        axes.set_xlabel(medians.PREDICTION_TIME)
    if _REFERENCE in set(scores["forecaster"]):
        band = style.band_handle("climatological forecast")
        figure.legend(handles=[band], loc="outside upper center")
    medians.say_where_empty(panels)
    style.letter_panels(panels)
    style.label_ends(figure, panels[1:])
    return figure


def _most_skilful(skills: pd.DataFrame) -> list[str]:
    """Sources of alarms with the largest mean skill, as many as a panel has, the best first.

    Alarms without a forecast are shown only where there is nothing else.
    """
    means = skills.groupby("forecaster")["value"].mean().drop(_ALWAYS_RIGHT, errors="ignore")
    means = means.sort_values(ascending=False, kind="stable")
    forecasting = means[[not looks.is_baseline(kind) for kind in means.index]]
    return [str(kind) for kind in (forecasting if len(forecasting) else means).index][
        : looks.MOST_LABELLED
    ]


def _draw_curve(axes: Axes, rows: pd.DataFrame, look: looks.MarkerStyle, kind: str) -> None:
    if not rows.empty:
        line: dict[str, Any] = {**look, "marker": "", "label": forecaster_label(kind)}
        axes.plot(rows[_TIME], rows["value"], **line)
        _draw_band(axes, rows, look["color"], 0.2)


def _draw_band(axes: Axes, rows: pd.DataFrame, colour: str, alpha: float) -> None:
    if not rows.empty:
        axes.fill_between(
            rows[_TIME], rows["low"], rows["high"], color=colour, alpha=alpha, linewidth=0
        )
