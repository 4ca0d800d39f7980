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

from burstcast.figures.parts.style import (
    DOUBLE_COLUMN,
    FLOOR,
    bar_handle,
    letter_panels,
    new_figure,
    sequence_styles,
    styled,
)
from burstcast.figures.registry import Declaration
from burstcast.forecasters._labels import forecaster_label
from burstcast.forecasters._names import described
from burstcast.probability.ranking import ONSET
from burstcast.tables.ranked import SAME_EVERYWHERE, shown_once

FIGURE = Declaration(
    section="forecasts",
    position=80,
    inputs={"tables": "encoded_cases/tables/ranking.csv"},
    cases="encoded",
)

_METRIC = "average_precision"
_CASE_KEYS = ["case", "alarm", "forecaster", "neurons", "seed"]
_LEFT_OUT = ("climatology", "persistence")


def draw(*, tables: Sequence[pd.DataFrame]) -> Figure:
    """Draw all forecasters of a flow and of the cases that are made from it."""
    return lost_skill(pd.concat(list(tables), ignore_index=True))


@styled
def lost_skill(ranking: pd.DataFrame) -> Figure:
    """Draw the equations beside the forecasters that learn.

    ``ranking``: The table ``ranking`` of all cases, of which only onsets are drawn.
    """
    onsets = ranking[ranking["event"] == ONSET]
    rates = onsets[onsets["metric"] == "base_rate"].groupby("prediction_time_lt")["value"].mean()
    rows = onsets[onsets["metric"] == _METRIC]
    rows = shown_once(rows[~rows["alarm"].isin(_LEFT_OUT)])
    known = rows["forecaster"].str.startswith("equations")
    figure = new_figure(DOUBLE_COLUMN, 4.2)
    panels: list[Axes] = list(figure.subplots(1, 2, sharey=True))
    learnt = rows[~known]
    for axes, part in zip(panels, (rows[known], learnt), strict=True):
        lines = [group for _, group in part.groupby(_CASE_KEYS, dropna=False)]
        lines.sort(key=lambda group: -group["value"].mean())
        if part is learnt:
            lines = _best_of_each(lines)
        for group, style in zip(lines, sequence_styles(len(lines)), strict=True):
            group = group.sort_values("prediction_time_lt")
            low, value, high = (
                group[name].to_numpy(dtype=np.float64) for name in ("low", "value", "high")
            )
            lengths = np.clip(np.nan_to_num([value - low, high - value]), 0.0, None)
            axes.errorbar(
                group["prediction_time_lt"].to_numpy(dtype=np.float64),
                value,
                yerr=lengths,
                label=_label(group.iloc[0]),
                elinewidth=0.6,
                markersize=3.5,
                **style,
            )
        axes.plot(rates.index, rates, **FLOOR, label="base rate")
        axes.set_xlabel("Prediction time [LT]")
        axes.set_ylim(0, 1.02)
        axes.legend(
            handles=[*axes.get_legend_handles_labels()[0], bar_handle("interval", caps=False)],
            loc="lower center",
            bbox_to_anchor=(0.5, 1.07),
            fontsize="small",
        )
    panels[0].set_ylabel("Average precision of onsets")
    letter_panels(panels)
    return figure


def _best_of_each(lines: Sequence[pd.DataFrame]) -> list[pd.DataFrame]:
    """The first line of each forecaster, whatever the case."""
    found = {tuple(group[_CASE_KEYS[2:]].astype(str).iloc[0]): group for group in reversed(lines)}
    return list(reversed(found.values()))


def _label(row: pd.Series) -> str:
    """Case and forecaster in words."""
    name = forecaster_label(str(row["forecaster"]))
    if row["alarm"] in SAME_EVERYWHERE:
        return name
    if pd.notna(row["neurons"]):
        name = described(name, row["neurons"])
    return f"{str(row['case']).replace('_', ' ')}: {name}"
