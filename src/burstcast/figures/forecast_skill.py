"""(a) F-score of the alarms, whose threshold was chosen on the calibration series, and (b) Brier
skill of the calibrated probabilities, against prediction time. Bands: bootstrap intervals over the
test series; of the median network, medians of the scores and of the ends of their intervals. The
committee is the share of these networks that forecast an event. Skills below -0.1 are cut off.
"""

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from burstcast.figures.parts.alarm_scores import OVER_SERIES, alarms_shown, calibrated, draw_alarms
from burstcast.figures.parts.percentile_curves import (
    METRIC_LABELS,
    PREDICTION_TIME_LABEL,
    require_single_case,
    say_where_empty,
)
from burstcast.figures.parts.style import (
    DOUBLE_COLUMN,
    band_handle,
    legend_above,
    letter_panels,
    new_figure,
    styled,
)
from burstcast.figures.registry import Declaration

FIGURE = Declaration(
    section="probabilities",
    position=10,
    inputs={"scores": "case/tables/probability_scores.csv"},
    settings={"neurons": "figures.fixed_neurons", "validation": "shown.validation"},
    cases="every",
)

_LABELS = {"f_score": METRIC_LABELS["f_score"], "brier_skill": "Brier skill score"}
_LOWEST = -0.1
"""Skills below are cut off: they are no use to anybody, and would squeeze the others."""


@styled
def draw(scores: pd.DataFrame, neurons: float, validation: str) -> Figure:
    """Draw F-score and Brier skill against prediction time.

    ``scores``: Scores of one case: forecaster, neurons, validation, seed, probability,
    prediction_time_lt, metric, value, low, high. Shown are calibrated probabilities. ``neurons``,
    ``validation``: Size and validation strategy of the networks that are shown; see
    `burstcast.figures.parts.alarm_scores.alarms_shown`.
    """
    require_single_case(scores)
    scores = alarms_shown(calibrated(scores), neurons, validation)
    figure = new_figure(DOUBLE_COLUMN, 3.6)
    panels = figure.subplots(1, 2, sharex=True)
    for axes, (metric, label) in zip(panels, _LABELS.items(), strict=True):
        draw_alarms(axes, scores[scores["metric"] == metric], "prediction_time_lt")
        axes.set_xlabel(PREDICTION_TIME_LABEL)
        axes.set_ylabel(label)
        axes.xaxis.set_major_locator(MultipleLocator(1))
        axes.set_ylim(0.0 if metric == "f_score" else _LOWEST, 1.03)
        axes.margins(x=0.02)
    legend_above(figure, panels, [band_handle(OVER_SERIES)], columns=4)
    say_where_empty(panels)
    letter_panels(list(panels))
    return figure
