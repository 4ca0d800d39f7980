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


def without_padding(states: FloatArray) -> list[FloatArray]:
    """Series ``(time, component)`` of ``(series, time, component)``, each with its own length."""
    lengths = series_lengths(states)
    if lengths is None:
        return list(states)
    return [series[:length] for series, length in zip(states, lengths, strict=True)]


def numbers_of(observable: FloatArray) -> FloatArray:
    """Observable ``(series, time)``; without NaN, ``(samples,)``, where shorter series have any."""
    missing = np.isnan(observable)
    return observable[~missing] if missing.any() else observable


def held_after_the_end(states: FloatArray) -> FloatArray:
    """Series whose NaN at the end are replaced by their last samples."""
    lengths = series_lengths(states)
    if lengths is None:
        return states
    step = np.minimum(np.arange(states.shape[1]), lengths[:, np.newaxis] - 1)
    held: FloatArray = np.take_along_axis(states, step[..., np.newaxis], axis=1)
    return held


def array_or_list(states: FloatArray) -> FloatArray | list[FloatArray]:
    """The array itself, or a list of its series where these have unequal lengths."""
    return states if series_lengths(states) is None else without_padding(states)


def series_lengths(states: FloatArray) -> IntArray | None:
    """Samples of each of ``(series, time, component)``; None if no series is filled up."""
    if not np.isnan(states[:, -1]).any():
        return None
    return np.asarray((~np.isnan(states[..., 0])).sum(axis=1), dtype=np.int64)


def samples_of(states: FloatArray) -> FloatArray:
    """All samples of series, ``(samples, component)``, without what fills them up."""
    flat = states.reshape(-1, states.shape[-1])
    return flat if series_lengths(states) is None else flat[~np.isnan(flat[:, 0])]
