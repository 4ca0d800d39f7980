"""F-score of the alarms, whose threshold was chosen on the calibration series (left), and Brier
skill of the calibrated probabilities (right), against prediction time: a row for each family of
forecasters. The grey band, the same in all rows, is the committee of networks: the share of these
networks that forecast an event. Bands: bootstrap intervals over the test series; of a network,
medians over the networks of an ensemble of the scores and of the ends of their intervals. Skills
below -0.1 are cut off.
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
_COMMITTEE = "esn_committee"


@figure(section="probabilities", position=10, cases="every")
def draw(
    *,
    scores: pd.DataFrame = read("case/tables/probability_scores.csv"),
    neurons: float = at("figures.fixed_neurons"),
    validation: str = at("shown.example.name.validation"),
) -> Figure:
    """Draw the F-score of alarms and the Brier skill against the prediction time."""
    scores = alarm_scores.alarms_shown(alarm_scores.calibrated(scores), neurons, validation)
    rows = looks.families(scores["forecaster"])
    figure = style.new_figure(style.DOUBLE_COLUMN, 0.9 + 1.25 * len(rows))
    panels = figure.subplots(len(rows), 2, sharex=True, sharey="col", squeeze=False)
    for column, (metric, label) in enumerate(_LABELS.items()):
        curves = alarm_scores.median_networks(scores[scores["metric"] == metric], _TIME)
        curves = curves.dropna(subset="value")
        for axes, (family, kinds) in zip(panels[:, column], rows, strict=True):
            _draw_band(axes, curves[curves["forecaster"] == _COMMITTEE], style.LIGHT_GREY, 0.8)
            for kind, look in zip(kinds, looks.categories(len(kinds)), strict=True):
                _draw_curve(axes, curves[curves["forecaster"] == kind], look, kind)
            axes.set_title(family, loc="center")
            axes.set_ylabel(label)
            axes.set_ylim(_LIMITS[metric])
            axes.margins(x=0.02)
    for axes in panels[-1]:
        axes.xaxis.set_major_locator(MultipleLocator(1))
        axes.set_xlabel(medians.PREDICTION_TIME)
    if _COMMITTEE in set(scores["forecaster"]):
        band = style.band_handle("committee of networks, in all rows")
        figure.legend(handles=[band], loc="outside upper center")
    medians.say_where_empty(panels.flat)
    style.letter_panels(list(panels.flat))
    style.label_ends(figure, panels[:, -1])
    return figure


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
