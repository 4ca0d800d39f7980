"""Economic value of the calibrated probabilities, relative to perfect forecasts (1) and to the base
rate (0), against the ratio of the cost of protection to the loss that it prevents: who can protect
themselves does so where the probability exceeds their ratio. Bands: bootstrap intervals over the
test series. Values below -0.1 are cut off.
"""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullFormatter, StrMethodFormatter

from burstcast.figures.parts.alarm_scores import alarms_shown, calibrated, draw_alarms, times_shown
from burstcast.figures.parts.percentile_curves import require_single_case, say_where_empty
from burstcast.figures.parts.style import (
    DOUBLE_COLUMN,
    legend_above,
    letter_panels,
    new_figure,
    styled,
)
from burstcast.figures.registry import Declaration

FIGURE = Declaration(
    section="probabilities",
    position=30,
    inputs={"values": "case/tables/economic_value.csv"},
    settings={
        "prediction_times_lt": "figures.reynolds_prediction_times_lt",
        "neurons": "figures.fixed_neurons",
        "validation": "shown.validation",
    },
)

_LOWEST = -0.1


@styled
def draw(
    values: pd.DataFrame, prediction_times_lt: Sequence[float], neurons: float, validation: str
) -> Figure:
    """Draw the value against the cost-loss ratio, a panel for each prediction time.

    Parameters
    ----------
    values
        Of one case: forecaster, neurons, validation, probability,
        prediction_time_lt, cost_loss_ratio, value, low, high. Shown are calibrated probabilities.
    prediction_times_lt
        Which are shown, of those in the table; the longest in the table where it has none of them.
    neurons, validation
        Of the networks that are shown; see `burstcast.figures.parts.alarm_scores.alarms_shown`.

    Raises
    ------
    ValueError
        If the table holds several cases.
    """
    require_single_case(values)
    values = alarms_shown(calibrated(values), neurons, validation)
    shown = times_shown(values, prediction_times_lt)
    figure = new_figure(DOUBLE_COLUMN, 3.4)
    panels = figure.subplots(1, len(shown), sharey=True, squeeze=False)[0]
    for axes, time in zip(panels, shown, strict=True):
        of_time = values[np.isclose(values["prediction_time_lt"], time)]
        draw_alarms(axes, of_time, "cost_loss_ratio")
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(FixedLocator([0.01, 0.03, 0.1, 0.3, 1.0]))
        axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_title(f"PT = {time:g} LT", loc="center")
        axes.set_xlabel("Cost-loss ratio")
    panels[0].set_ylabel("Relative economic value")
    panels[0].set_ylim(_LOWEST, 1.03)
    legend_above(figure, panels, columns=4)
    say_where_empty(panels)
    letter_panels(list(panels))
    return figure
