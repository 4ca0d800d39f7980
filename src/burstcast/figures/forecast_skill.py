"""(a) F-score of the alarms, whose threshold was chosen on the calibration series, and (b) Brier
skill of the calibrated probabilities, against prediction time. Bands: bootstrap intervals over the
test series; of the median network, medians of the scores and of the ends of their intervals. The
committee is the share of these networks that forecast an event. Skills below -0.1 are cut off.
"""

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from burstcast.base.declared import at, read
from burstcast.figures.parts import alarm_scores, medians, style
from burstcast.figures.registry import figure

_LABELS = {"f_score": medians.LABELS["f_score"], "brier_skill": "Brier skill score"}
_LOWEST = -0.1
"""Lower end of the axis of skill: values below it would compress the others."""


@figure(section="probabilities", position=10, cases="every")
def draw(
    *,
    scores: pd.DataFrame = read("case/tables/probability_scores.csv"),
    neurons: float = at("figures.fixed_neurons"),
    validation: str = at("shown.example.name.validation"),
) -> Figure:
    """Draw F-score and Brier skill of calibrated probabilities against prediction time."""
    scores = alarm_scores.alarms_shown(alarm_scores.calibrated(scores), neurons, validation)
    figure = style.new_figure(style.DOUBLE_COLUMN, 3.6)
    panels = figure.subplots(1, 2, sharex=True)
    for axes, (metric, label) in zip(panels, _LABELS.items(), strict=True):
        rows = scores[scores["metric"] == metric]
        alarm_scores.draw_alarms(axes, rows, "prediction_time_lt")
        axes.set_xlabel(medians.PREDICTION_TIME)
        axes.set_ylabel(label)
        axes.xaxis.set_major_locator(MultipleLocator(1))
        axes.set_ylim(0.0 if metric == "f_score" else _LOWEST, 1.03)
        axes.margins(x=0.02)
    bands = style.band_handle("interval over test series")
    style.legend_above(figure, panels, [bands], columns=4)
    medians.say_where_empty(panels)
    style.letter_panels(list(panels))
    return figure
