"""Series of unequal lengths in one array: shorter ones are filled up with NaN at their ends."""

from collections.abc import Sequence

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray


def padded(series: Sequence[FloatArray]) -> FloatArray:
    """Series ``(time, component)`` side by side, ``(series, longest time, component)``.

    Examples
    --------
    >>> padded([np.ones((3, 1)), np.ones((1, 1))])[:, :, 0].tolist()
    [[1.0, 1.0, 1.0], [1.0, nan, nan]]
    """
    filled = np.full((len(series), max(map(len, series)), series[0].shape[1]), np.nan)
    for row, states in enumerate(series):
        filled[row, : len(states)] = states
    return filled


def series_lengths(states: FloatArray) -> IntArray | None:
    """Samples of each of ``(series, time, component)``; None if no series is filled up."""
    if not np.isnan(states[:, -1]).any():
        return None
    return np.asarray((~np.isnan(states[..., 0])).sum(axis=1), dtype=np.int64)


def samples_of(states: FloatArray) -> FloatArray:
    """All samples of series, ``(samples, component)``, without what fills them up."""
    flat = states.reshape(-1, states.shape[-1])
    return flat if series_lengths(states) is None else flat[~np.isnan(flat[:, 0])]
