"""Logarithmic axes that have a place for zero."""

from typing import Any

import numpy as np
import pandas as pd


def linear_below(values: "pd.Series[Any]", smallest: float) -> float:
    """Limit of the linear part of a logarithmic axis: a power of ten, at most 0.1.

    It is not above the least positive value, unless its exponent would be below ``smallest``.
    """
    least = float(values[values > 0].min()) if (values > 0).any() else 0.1
    return float(10.0 ** np.clip(np.floor(np.log10(least)), smallest, -1))
