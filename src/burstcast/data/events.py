"""The extreme event: where it begins.

Source: the paper calls an extreme event what happens where the observable reaches the event
threshold, k >= k_e, after being below it.
"""

import numpy as np

from burstcast.base.arrays import BoolArray, FloatArray


def upward_crossings(observable: FloatArray, threshold: float, axis: int = -1) -> BoolArray:
    """Mark the starts of extreme events: steps at or above the threshold after one below it.

    The first step never starts an event: whether one was under way before is not known.
    ``threshold``: The event threshold, k_e. Returns a mask of the observable's shape, with time
    along ``axis``.

    Examples
    --------
    >>> upward_crossings(np.array([0.3, 0.05, 0.2, 0.2, 0.0, 0.1]), 0.1).tolist()
    [False, False, True, False, False, True]
    """
    above = np.moveaxis(observable, axis, -1) >= threshold
    starts = np.zeros_like(above)
    starts[..., 1:] = above[..., 1:] & ~above[..., :-1]
    return np.moveaxis(starts, -1, axis)
