"""The one layout of series: ``(series, time, component)``.

Whatever takes series from a user takes them like this, as an array of NumPy or of xarray:

========= ===========================================================================
series    realisations, each observed on its own; a single one is ``series[np.newaxis]``
time      samples at equal intervals, one step of a forecast each
component what is observed of the state, in units of its own
========= ===========================================================================

An array of xarray may have these three dimensions in any order: they are found by their names.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from burstcast.arrays import FloatArray, float_array, is_known

LAYOUT = ("series", "time", "component")
"""Names of the dimensions."""


def as_series(data: Any, what: str = "the series") -> FloatArray:
    """Series of a user as an array of the one layout.

    ``data``: An array of NumPy, or what can be made one, of shape ``(series, time, component)``; or
    an array of xarray with dimensions of these names. Shape ``(series, time, component)``,
    contiguous.
    """
    if hasattr(data, "data_vars"):
        raise TypeError(f"{what}: a data set has several variables; give one of them")
    if hasattr(data, "dims"):  # of xarray, which need not be installed
        if sorted(map(str, data.dims)) != sorted(LAYOUT):
            named = ", ".join(map(str, data.dims))
            raise ValueError(
                f"{what} must have the dimensions {', '.join(LAYOUT)}, not {named}: rename them "
                f"(.rename), or add the missing ones (.expand_dims)"
            )
        if "time" in getattr(data, "coords", ()):
            _check_times(np.asarray(data.coords["time"]), what)
        data = data.transpose(*LAYOUT).to_numpy()
    if isinstance(data, list | tuple):
        _check_equal_lengths(data, what)
        # tables of pandas, whose nullable and Arrow types have another mark for missing numbers
        data = [
            one.to_numpy(dtype=np.float64, na_value=np.nan) if hasattr(one, "dtypes") else one
            for one in data
        ]
    series = np.ascontiguousarray(float_array(data, what))
    if np.ndim(data) != len(LAYOUT):
        single = "series[np.newaxis]" if np.ndim(data) == 2 else "series[np.newaxis, :, np.newaxis]"
        hint = f": a single series is {single}" if np.ndim(data) < 3 else ""
        hint = ": a single table is [table]" if hasattr(data, "iloc") else hint
        raise ValueError(f"{what} must be ({', '.join(LAYOUT)}), not {np.shape(data)}{hint}")
    if series.size == 0:
        raise ValueError(f"{what} of shape {series.shape} are empty")
    known = is_known(series)
    if not known.all():
        row, step, component = (int(index) for index in np.argwhere(~known)[0])
        raise ValueError(
            f"{what} must be finite: series {row} is {series[row, step, component]:g} at step "
            f"{step}, component {component}"
        )
    return series


def _check_times(time: Any, what: str) -> None:
    """Check that a coordinate of times rises."""
    if time.dtype.kind in "iufM" and not (time[1:] > time[:-1]).all():
        raise ValueError(f"{what}: the coordinate time must rise from each sample to the next")


def _check_equal_lengths(data: Sequence[Any], what: str) -> None:
    lengths = [len(one) for one in data if hasattr(one, "__len__")]
    if other := [number for number, length in enumerate(lengths) if length != lengths[0]]:
        raise ValueError(
            f"{what} have unequal lengths: series 0 has {lengths[0]} samples, series {other[0]} "
            f"{lengths[other[0]]}; cut them to one length"
        )
