"""Rows of the tables of probabilities that figures show."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from burstcast.figures.parts.medians import nearest_value


def alarms_shown(table: pd.DataFrame, neurons: float, validation: str) -> pd.DataFrame:
    """Rows of networks of one size and strategy, and of all other sources of alarms.

    Where the table has no such size, the nearest one; where it has no such strategy, all strategies
    of that size. A table of committees has no network if there is but one seed.
    """
    networks = table["neurons"].notna()
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


def median_networks(table: pd.DataFrame, x: str) -> pd.DataFrame:
    """Medians over networks that differ by their seeds, for each value of x: of scores and of ends.

    The band is then an interval over test series, like all other bands.
    """
    return table.groupby(["forecaster", x])[["value", "low", "high"]].median().reset_index()
