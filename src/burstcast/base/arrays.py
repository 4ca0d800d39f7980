"""Types of arrays by their entries, array layouts, and conversion of input to arrays.

================================================================ ==============================
array                                                            shape
================================================================ ==============================
stored data: ensemble, training series                           (series, time, component)
batch of states of a dynamical system                            (dimension, ...)
batch of washouts or forecasts, inputs and outputs of a network  (steps, dimension, batch)
schedule: parameters in force from each step to the next         (steps, parameters, batch)
series with exogenous inputs (`burstcast.base.exogenous`)        (series, time, component)
batch of reservoir states                                        (neurons, batch)
memory of any forecaster                                         (..., batch)
readout weights, the bias last                                   (neurons + 1, dimension)
================================================================ ==============================

All arrays are float64. Time counts in steps of a forecast (``sampling_interval``) unless a name
ends in ``_lt`` (Lyapunov times) or says "time units". A duration of x Lyapunov times is
``floor(x * steps_per_lyapunov_time)`` steps (`burstcast.base.durations.steps`). A washout ends with
the starting point: the first forecast state is one step later.
"""

from typing import Any

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
IntArray = npt.NDArray[np.int64]
"""Counts and indices."""
Int32Array = npt.NDArray[np.int32]
"""Indices of sparse matrices, as scipy stores them."""
ByteArray = npt.NDArray[np.uint8]
"""Small numbers that choose between a few things."""

AXES = ("series", "time", "component")
"""Names of the dimensions of series, in their order."""

_NEVER_WRITTEN = (9.969e36, 9.970e36)
"""Bounds of the number that netCDF stores where nothing was written."""


def sum_of_rows(rows: FloatArray) -> FloatArray:
    """Sum over the first axis, row by row: the same bits in each layout of the memory."""
    total: FloatArray = rows[0]
    for row in rows[1:]:
        total = total + row
    return total


def float_array(data: Any, what: str) -> FloatArray:
    """Convert the input of a user to float64.

    Returns an array of the same shape, ``data`` itself where nothing has to be converted.
    """
    try:
        array = np.asanyarray(data)
    except (TypeError, ValueError) as error:
        raise TypeError(f"{what} must consist of real numbers: {error}") from error
    if array.dtype.kind not in "biuf":
        raise TypeError(f"{what} must consist of real numbers, not of {array.dtype}")
    if _is_masked(data):
        masked = np.argwhere(np.array(_mask(data)))
        place = ", ".join(map(str, masked[0]))
        raise ValueError(
            f"{what} must not be masked: the entry [{place}] is ({len(masked)} in all); fill gaps, "
            f"or leave out what has them"
        )
    return np.asarray(np.ma.getdata(array), dtype=np.float64)


def _is_masked(data: Any) -> bool:
    """Whether an entry of an array, or of nested lists of arrays, is masked."""
    if isinstance(data, list | tuple):
        return any(map(_is_masked, data))
    return isinstance(data, np.ma.MaskedArray) and bool(np.ma.is_masked(data))


def _mask(data: Any) -> Any:
    """Mask of nested lists of arrays, as nested lists of arrays."""
    if isinstance(data, list | tuple):
        return [_mask(item) for item in data]
    return np.ma.getmaskarray(data)


def is_known(values: FloatArray) -> BoolArray:
    """Whether values are finite and no fill values of netCDF."""
    low, high = _NEVER_WRITTEN
    return np.asarray(np.isfinite(values) & ~((values > low) & (values < high)))
