"""Where skill is lost between a flow and a forecast of its events: average precision of onsets
against the prediction time. (a) The equations, started from the true state, from noisy or few
observations of it, and from encoded states. (b) Forecasters that learn from the channels of
encoded cases, each in the case where it ranks best, and alarms without a forecast; of networks the
committee of each size. Single trajectories rank starting points by the largest observable that they
forecast. The grey line is the base rate, which chance reaches. Bars: bootstrap intervals over test
series.
"""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from burstcast.base.declared import read
from burstcast.base.names import described
from burstcast.figures.parts import looks, medians, style
from burstcast.figures.parts.ranked import SAME_EVERYWHERE, shown_once
from burstcast.figures.registry import figure
from burstcast.forecasters._labels import forecaster_label
from burstcast.forecasts.ranking import ONSET

_METRIC = "average_precision"
_FORECASTER = ["forecaster", "neurons", "seed"]
_LEFT_OUT = ("climatology", "persistence")


@figure(section="forecasts", position=80, cases="encoded")
def draw(
    *,
    tables: Sequence[pd.DataFrame] = read("encoded_cases/tables/ranking.csv"),
) -> Figure:
    """Draw all forecasters of a flow and of the cases made from it."""
    ranking = pd.concat(list(tables), ignore_index=True)
    onsets = ranking[ranking["event"] == ONSET]
    rates = onsets[onsets["metric"] == "base_rate"].groupby("prediction_time_lt")["value"].mean()
    rows = onsets[onsets["metric"] == _METRIC]
    rows = shown_once(rows[~rows["alarm"].isin(_LEFT_OUT)])
    known = rows["forecaster"].str.startswith("equations")
    figure = style.new_figure(style.DOUBLE_COLUMN, 4.2)
    panels: list[Axes] = list(figure.subplots(1, 2, sharey=True))
    for axes, learnt in zip(panels, (False, True), strict=True):
        groups = rows[known != learnt].groupby(["case", "alarm", *_FORECASTER], dropna=False)
        lines = sorted((group for _, group in groups), key=lambda group: -group["value"].mean())
        if learnt:  # each where it ranks best
            names = [tuple(group[_FORECASTER].astype(str).iloc[0]) for group in lines]
            lines = [group for n, group in enumerate(lines) if names[n] not in names[:n]]
        for group, look in zip(lines, looks.sequence(len(lines)), strict=True):
            group = group.sort_values("prediction_time_lt")
            axes.errorbar(
                group["prediction_time_lt"].to_numpy(dtype=np.float64),
                group["value"].to_numpy(dtype=np.float64),
                yerr=medians.lengths(group, "value", "low", "high"),
                label=_label(group.iloc[0]),
                elinewidth=0.6,
                markersize=3.5,
                **look,
            )
        axes.plot(rates.index, rates, **looks.FLOOR, label="base rate")
        axes.set_xlabel(medians.PREDICTION_TIME)
        axes.set_ylim(0, 1.02)
        axes.legend(
            handles=[
                *axes.get_legend_handles_labels()[0],
                style.bar_handle("interval", caps=False),
            ],
            loc="lower center",
            bbox_to_anchor=(0.5, 1.07),
            fontsize="small",
        )
    panels[0].set_ylabel("Average precision of onsets")
    style.letter_panels(panels)
    return figure


def _label(row: pd.Series) -> str:
    """Case and forecaster in words."""
    name = forecaster_label(str(row["forecaster"]))
    if row["alarm"] in SAME_EVERYWHERE:
        return name
    if pd.notna(row["neurons"]):
        name = described(name, float(row["neurons"]))
    return f"{str(row['case']).replace('_', ' ')}: {name}"
