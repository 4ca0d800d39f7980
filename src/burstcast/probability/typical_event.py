"""A typical event, with neither the best nor the worst forecast."""

import numpy as np

from burstcast.arrays import BoolArray, FloatArray


def typical_event(probability: FloatArray, happened: BoolArray, scored: BoolArray) -> int | None:
    """Starting point that an event follows, and whose probability is the median of all of these.

    ``probability``: Forecast at each starting point, ``(points,)``. ``happened``: Whether an event
    followed, ``(points,)``. Returns position of the point: the first one with the (lower) median
    probability; None if no event followed any point.
    """
    rows = np.flatnonzero(happened & scored)
    if rows.size == 0:
        return None
    median = np.sort(probability[rows])[(rows.size - 1) // 2]
    return int(rows[np.argmax(probability[rows] == median)])
