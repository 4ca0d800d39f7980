"""Return levels: levels of the observable against their return periods, the mean time from one
event of the level to the next, in long runs without control and with it. Bars: intervals of the
counts, of independent events or of clusters. Open markers with an arrow: no event was observed, and
the return period is longer than the marker, with the confidence of the intervals. Excursions that
end in laminarisation are no events. Actuators act in time and with full strength in the first
panel, late or weakly in the other one; of each strategy and forecaster the run is shown in which
the lowest level is rarest.
"""

from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from burstcast.base.declared import at, read
from burstcast.figures.parts import looks, medians, style
from burstcast.figures.registry import figure
from burstcast.forecasters._labels import forecaster_label

FREE = "uncontrolled"
_RESULTS = {
    *("return_level", "events", "return_time", "return_time_low", "return_time_high"),
    *("dispersion", "independent", "lyapunov_times", "flows", "exceedance", "laminarisations"),
    "control_fraction",
}


@figure(section="control", position=60, cases="long_controlled")
def draw(
    *,
    times: pd.DataFrame = read("case/tables/return_times.csv"),
    symbol: str = at("case.space.observable_symbol"),
) -> Figure:
    """Draw at most four runs in a panel, those in which the lowest level is rarest."""
    times = times.assign(run=_runs(times))
    free = times[times["strategy"] == FREE]
    controlled = times[times["strategy"] != FREE]
    usual = (controlled["delay_lt"] == 0) & (controlled["strength"] == 1)
    contents = [controlled[usual], controlled[~usual]]
    contents = [content for content in contents if not content.empty] or [controlled]
    width = style.DOUBLE_COLUMN if len(contents) > 1 else style.SINGLE_COLUMN
    drawing = style.new_figure(width, 3.6)
    panels = style.grid_of(drawing, len(contents), len(contents), sharex=True, sharey=True)
    for axes, content in zip(panels, contents, strict=True):
        if not free.empty:
            _draw(axes, free[free["run"] == free["run"].iloc[0]], looks.TRUTH, "no control")
        shown = _rarest(content)
        for run, look in zip(shown, looks.categories(len(shown)), strict=True):
            rows = content[content["run"] == run]
            _draw(axes, rows, look, _label(rows.iloc[0]))
        axes.set_xscale("log")
        axes.set_xlabel("Return period [LT]")
        # below the axes: curves reach all corners
        axes.legend(loc="upper left", bbox_to_anchor=(0.0, -0.18), fontsize=6.5)
    panels[0].set_ylabel(f"Return level of ${symbol}$")
    style.letter_panels(panels)
    return drawing


def _runs(times: pd.DataFrame) -> list[int]:
    """Number of the run that each row belongs to."""
    keys = [name for name in times.columns if name not in _RESULTS]
    numbers: list[int] = times.groupby(keys, dropna=False, sort=False).ngroup().tolist()
    return numbers


def _rarest(rows: pd.DataFrame) -> list[int]:
    """Runs to show: one of each strategy, forecaster and condition, by the lowest level."""
    lowest = rows[rows["return_level"] == rows["return_level"].min()]
    best = lowest.sort_values("return_time_low", ascending=False, kind="stable")
    best = best.drop_duplicates(["strategy", "forecaster", "delay_lt", "strength"])
    chosen: list[int] = best["run"].head(looks.MOST_CURVES).tolist()
    return chosen


def _label(run: pd.Series) -> str:
    """Strategy, forecaster and condition in words."""
    title, _ = looks.strategy(run["strategy"])
    parts = [title]
    if run["forecaster"] != "none":
        parts.append(forecaster_label(run["forecaster"]))
    if run["delay_lt"]:
        parts.append(f"{run['delay_lt']:g} LT late")
    if run["strength"] != 1:
        parts.append(f"strength {run['strength']:g}")
    return ", ".join(parts)


def _draw(axes: Axes, rows: pd.DataFrame, look: Any, label: str) -> None:
    """Draw a run: intervals along the return period, and bounds where nothing was observed."""
    rows = rows.sort_values("return_level")
    seen = rows[rows["events"] > 0]
    bars = medians.lengths(seen, "return_time", "return_time_low", "return_time_high")
    look = {"marker": "o", **look, "markersize": 3.0, **style.BARS}
    axes.errorbar(seen["return_time"], seen["return_level"], xerr=bars, label=label, **look)
    unseen = rows[rows["events"] == 0].head(1)
    if not unseen.empty:
        bound = unseen["return_time_low"]
        look |= {"linestyle": "none", "markerfacecolor": "white"}
        axes.errorbar(bound, unseen["return_level"], xerr=0.4 * bound, xlolims=True, **look)
