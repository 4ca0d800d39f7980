"""Economic value of the calibrated probabilities, relative to perfect forecasts (1) and to the base
rate (0), against the ratio of the cost of protection to the loss that it prevents: users
protect where the probability exceeds their ratio. Bands: bootstrap intervals over the
test series. Values below 0, where the base rate serves better, are drawn at 0.
"""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullFormatter, StrMethodFormatter

from burstcast.figures.parts.alarm_scores import (
    OVER_SERIES,
    alarms_shown,
    calibrated,
    draw_alarms,
    median_network,
    times_shown,
)
from burstcast.figures.parts.percentile_curves import require_single_case, say_where_empty
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
    position=30,
    inputs={"values": "case/tables/economic_value.csv"},
    settings={
        "prediction_times_lt": "figures.reynolds_prediction_times_lt",
        "neurons": "figures.fixed_neurons",
        "validation": "shown.validation",
    },
)


def from_zero(curve: pd.DataFrame, x: str) -> pd.DataFrame:
    """Draw a curve at 0 where it falls below, from where it meets 0 on a logarithmic axis.

    Parameters
    ----------
    curve
        Curve of one forecaster, the columns ``x``, value, low, high.
    x
        Name of the column on the horizontal axis, positive.

    Returns
    -------
    Rows with the points where the value is 0 among them; neither values nor ends of intervals are
    below 0.
    """
    curve = curve.sort_values(x)
    place, value = np.log(curve[x].to_numpy(dtype=float)), curve["value"].to_numpy(dtype=float)
    change = np.flatnonzero(value[:-1] * value[1:] < 0)
    share = value[change] / (value[change] - value[change + 1])
    zeros = place[change] + share * (place[change + 1] - place[change])
    names = ["value", "low", "high"]
    added = {name: np.interp(zeros, place, curve[name]) for name in names}
    added["value"] = np.zeros(len(zeros))
    whole = pd.concat([curve, pd.DataFrame({x: np.exp(zeros), **added})]).sort_values(x)
    whole["forecaster"] = curve["forecaster"].iloc[0]
    whole[names] = whole[names].clip(lower=0)
    return whole


@styled
def draw(
    values: pd.DataFrame, prediction_times_lt: Sequence[float], neurons: float, validation: str
) -> Figure:
    """Draw the value against the cost-loss ratio, a panel for each prediction time.

    Parameters
    ----------
    values
        Values of one case: forecaster, neurons, validation, probability, prediction_time_lt,
        cost_loss_ratio, value, low, high. Shown are calibrated probabilities.
    prediction_times_lt
        Prediction times to show; the longest in the table where the table has none of them.
    neurons, validation
        Size and validation strategy of the networks that are shown; see
        `burstcast.figures.parts.alarm_scores.alarms_shown`.

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
        curves = median_network(of_time, "cost_loss_ratio").groupby("forecaster")
        cut = [from_zero(curve, "cost_loss_ratio") for _, curve in curves]
        draw_alarms(axes, pd.concat(cut), "cost_loss_ratio")
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(FixedLocator([0.01, 0.03, 0.1, 0.3, 1.0]))
        axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_title(f"PT = {time:g} LT", loc="center")
        axes.set_xlabel("Cost-loss ratio")
    panels[0].set_ylabel("Relative economic value")
    panels[0].set_ylim(-0.01, 1.03)
    legend_above(figure, panels, [band_handle(OVER_SERIES)], columns=4)
    say_where_empty(panels)
    letter_panels(list(panels))
    return figure
