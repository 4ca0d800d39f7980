"""Bootstrap intervals over events for the average prediction horizon."""

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray


def resampled_averages(horizons_lt: FloatArray, weights: IntArray) -> tuple[FloatArray, FloatArray]:
    """Mean and median horizon of each bootstrap sample of events, ``(resamples,)`` each.

    ``weights``: How often each event is in each sample, ``(resamples, events)``.
    """
    if horizons_lt.size == 0:
        return np.empty(0), np.empty(0)
    order = np.argsort(horizons_lt, kind="stable")
    ordered, count = horizons_lt[order], int(weights[0].sum())
    reached = np.cumsum(weights[:, order], axis=1)
    # the two in the middle of the sample, which are one if their number is odd
    middle = [ordered[(reached > rank).argmax(axis=1)] for rank in ((count - 1) // 2, count // 2)]
    return (weights * horizons_lt).sum(axis=1) / count, 0.5 * (middle[0] + middle[1])
