"""Where skill is lost between a flow and a forecast of its events: average precision of onsets
against the prediction time. (a) The equations, started from noisy or few observations of the state,
and from encoded states; from the true state they are right throughout. (b) Other forecasters, which
learn from the channels of encoded cases, each kind in the case and size where its mean over the
times is largest, or are alarms without a forecast. Six curves at most in a panel, with the largest
means. Single trajectories rank starting points by the largest observable that they forecast. The
grey line is the base rate, which chance reaches. Bars: bootstrap intervals over test series.
"""

import textwrap
from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from burstcast.base.declared import read
from burstcast.base.names import described
from burstcast.figures.parts import looks, medians, style
from burstcast.figures.parts.ranked import SAME_EVERYWHERE, shown_once
from burstcast.figures.registry import figure
from burstcast.forecasters._labels import forecaster_label
from burstcast.forecasts.scores import ONSET

_METRIC = "average_precision"
_LEFT_OUT = ("climatology", "persistence", "equations")
_EQUATIONS = "equations"


@figure(section="forecasts", position=80, cases="encoded")
def draw(*, tables: Sequence[pd.DataFrame] = read("encoded_cases/tables/ranking.csv")) -> Figure:
    """Draw all forecasters of a flow and of the cases made from it."""
    ranking = pd.concat(list(tables), ignore_index=True)
    onsets = ranking[ranking["event"] == ONSET]
    rates = onsets[onsets["metric"] == "base_rate"].groupby("prediction_time_lt")["value"].mean()
    rows = onsets[onsets["metric"] == _METRIC]
    rows = shown_once(rows[~rows["alarm"].isin(_LEFT_OUT)])
    means = rows.groupby(["case", "alarm"])["value"].transform("mean")
    order = ["mean", "prediction_time_lt"]
    rows = rows.assign(mean=means).sort_values(order, ascending=[False, True])
    by_equations = rows["forecaster"].str.startswith(_EQUATIONS)
    learnt = rows[~by_equations]
    best = learnt.drop_duplicates("forecaster")[["case", "alarm"]]
    contents = [
        (title, _curves(shown))
        for title, shown in (
            ("equations", rows[by_equations]),
            ("other forecasters", learnt.merge(best)),
        )
        if len(shown)
    ]
    if not contents:
        return style.nothing_to_show("No forecaster ranks onsets.")
    figure = style.new_figure(style.DOUBLE_COLUMN, 2.7)
    panels = style.grid_of(figure, len(contents), len(contents), sharex=True, sharey=True)
    for axes, (title, curves) in zip(panels, contents, strict=True):
        for curve, look in zip(curves, looks.categories(len(curves)), strict=True):
            axes.errorbar(
                curve["prediction_time_lt"].to_numpy(dtype=np.float64),
                curve["value"].to_numpy(dtype=np.float64),
                yerr=medians.lengths(curve, "value", "low", "high"),
                label=textwrap.fill(_label(curve.iloc[0]), 24),
                elinewidth=0.6,
                markersize=3.5,
                **look,
            )
        axes.plot(rates.index, rates, **looks.FLOOR)
        axes.set_ylim(0, 1.04)
        axes.set_title(title, loc="center")
        axes.set_xlabel(medians.PREDICTION_TIME)
    panels[0].set_ylabel("Average precision of onsets")
    style.letter_panels(panels)
    style.label_ends(figure, panels)
    return figure


def _curves(rows: pd.DataFrame) -> list[pd.DataFrame]:
    """Curves of a panel, in the order of their means."""
    curves = [curve for _, curve in rows.groupby(["case", "alarm"], sort=False)]
    return curves[: looks.MOST_LABELLED]


def _label(row: pd.Series) -> str:
    """Case and forecaster in words; the panel says where it is the equations."""
    name = forecaster_label(str(row["forecaster"])).removeprefix(f"{_EQUATIONS}, ")
    if row["alarm"] in SAME_EVERYWHERE:
        return name
    if pd.notna(row["neurons"]):
        name = described(name, float(row["neurons"]))
    return f"{str(row['case']).replace('_', ' ')}: {name}"
