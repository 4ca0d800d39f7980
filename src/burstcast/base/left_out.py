"""Training series that are left out of a refitted forecaster, which then forecasts them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from burstcast.base.arrays import IntArray


class LeftOut(NamedTuple):
    """Training series that a forecaster forecasts, and series that it must not learn from."""

    forecast: IntArray  #: rows of the series that it forecasts
    rows: IntArray  #: rows of the series that are left out: with what shares samples


def rows_left_out(series: int, left_out: Sequence[LeftOut] | None) -> list[IntArray]:
    """Rows that are left out of each training: given ones, or each row by itself."""
    if series < 2:
        raise ValueError("leaving one series out takes two training series at least")
    if left_out is None:
        return [np.array([row]) for row in range(series)]
    return [each.rows for each in left_out]
