"""Scores of all sources of alarms, as curves with their intervals."""

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from burstcast.figures.parts import looks
from burstcast.figures.parts.medians import nearest_value

_NETWORKS = ("esn", "esn_committee")


def alarms_shown(table: pd.DataFrame, neurons: float, validation: str) -> pd.DataFrame:
    """Rows of networks of one size and strategy, and of all other sources of alarms.

    Where the table has no such size, the nearest one; where it has no such strategy, all strategies
    of that size. A table of committees has no network if there is but one seed.
    """
    networks = table["forecaster"].isin(_NETWORKS)
    if not networks.any():
        return table
    chosen = networks & (table["neurons"] == nearest_value(table[networks], "neurons", neurons))
    if (chosen & (table["validation"] == validation)).any():
        chosen &= table["validation"] == validation
    return table[~networks | chosen]


def calibrated(table: pd.DataFrame) -> pd.DataFrame:
    """Rows of calibrated probabilities: shares of votes as they are have rows of their own."""
    return table[table["probability"] == "calibrated"]


def times_shown(table: pd.DataFrame, wanted: Sequence[float]) -> list[float]:
    """Prediction times of the table among those wanted, or else its longest."""
    times = table["prediction_time_lt"]
    return [time for time in wanted if np.isclose(times, time).any()] or [float(times.max())]


def median_network(table: pd.DataFrame, x: str) -> pd.DataFrame:
    """Replace single networks by medians over them, for each value of x: of scores and of ends.

    The band is then an interval over test series, like all other bands.
    """
    single = table["forecaster"] == "esn"
    median = table[single].groupby(x)[["value", "low", "high"]].median()
    median = median.reset_index().assign(forecaster="esn")
    return pd.concat([table[~single], median], ignore_index=True)


def draw_alarms(axes: Axes, table: pd.DataFrame, x: str) -> None:
    """Draw a curve of one metric for each kind of forecaster, with a band from low to high."""
    table = median_network(table, x)
    for kind in looks.ordered_forecasters(set(table["forecaster"])):
        rows = table[(table["forecaster"] == kind) & table["value"].notna()].sort_values(x)
        if rows.empty:
            continue
        look = looks.forecaster_line(kind)
        if kind == "esn":
            look["label"] = "median network"
        network = kind in _NETWORKS
        position, value = (rows[name].to_numpy(dtype=np.float64) for name in (x, "value"))
        band = {"color": look["color"], "alpha": 0.2 if network else 0.12, "linewidth": 0}
        axes.fill_between(position, rows["low"], rows["high"], **band)
        # networks are bold, and in front
        width, front = (1.4, 2.5) if network else (1.0, 2.0)
        axes.plot(position, value, linewidth=width, zorder=front, **look)
