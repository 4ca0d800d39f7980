"""(a) Share of the events that an alarm warned of at least a lead time before they began, and (b)
false alarms per Lyapunov time, against lead time; the axis is linear in the shaded strip. Bands:
bootstrap intervals over the test series; of the median network, medians of the scores and of the
ends of their intervals. The threshold of alarms by the observable now jumps from one lead time to
the next: they are in the table alone.
"""

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from burstcast.figures.parts.alarm_scores import OVER_SERIES, alarms_shown, draw_alarms
from burstcast.figures.parts.linear_below import linear_below
from burstcast.figures.parts.percentile_curves import require_single_case, say_where_empty
from burstcast.figures.parts.style import (
    DOUBLE_COLUMN,
    LIGHT_GREY,
    band_handle,
    legend_above,
    letter_panels,
    new_figure,
    styled,
)
from burstcast.figures.registry import Declaration

FIGURE = Declaration(
    section="probabilities",
    position=40,
    inputs={"lead_times": "case/tables/lead_times.csv"},
    settings={"neurons": "figures.fixed_neurons", "validation": "shown.validation"},
)

_LABELS = {
    "warned_fraction": "Share of events warned of",
    "false_alarms_per_lt": "False alarms per LT",
}


@styled
def draw(lead_times: pd.DataFrame, neurons: float, validation: str) -> Figure:
    """Draw the share of events warned of, and false alarms, against lead time.

    Parameters
    ----------
    lead_times
        Lead times of one case: forecaster, neurons, validation, seed, lead_time_lt, metric, value,
        low, high.
    neurons, validation
        Size and validation strategy of the networks that are shown; see
        `burstcast.figures.parts.alarm_scores.alarms_shown`.

    Raises
    ------
    ValueError
        If the table holds several cases.
    """
    require_single_case(lead_times)
    lead_times = alarms_shown(lead_times, neurons, validation)
    lead_times = lead_times[lead_times["forecaster"] != "observable_now"]
    figure = new_figure(DOUBLE_COLUMN, 3.4)
    panels = figure.subplots(1, 2, sharex=True)
    for axes, (metric, label) in zip(panels, _LABELS.items(), strict=True):
        draw_alarms(axes, lead_times[lead_times["metric"] == metric], "lead_time_lt")
        axes.set_xlabel("Lead time [LT]")
        axes.set_ylabel(label)
        axes.xaxis.set_major_locator(MultipleLocator(1))
        axes.margins(x=0.02)
    panels[0].set_ylim(bottom=0.0)
    # baselines raise orders of magnitude more than forecasters, some of which raise none
    found = lead_times.loc[lead_times["metric"] == "false_alarms_per_lt", "value"]
    end = linear_below(found, -6)
    panels[1].set_yscale("symlog", linthresh=end, linscale=0.4)
    panels[1].set_ylim(bottom=-0.1 * end)
    panels[1].axhspan(-0.1 * end, end, color=LIGHT_GREY, alpha=0.5, linewidth=0, zorder=0.2)
    legend_above(figure, panels, [band_handle(OVER_SERIES)], columns=4)
    say_where_empty(panels)
    letter_panels(list(panels))
    return figure
