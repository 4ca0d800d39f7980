"""The one layout of series: ``(series, time, component)``.

Whatever takes series from a user takes them like this, as an array of NumPy or of xarray:

========= ===========================================================================
series    realisations, each observed on its own; a single one is ``series[np.newaxis]``
time      samples at equal intervals, one step of a forecast each
component what is observed of the state, in units of its own
========= ===========================================================================

What xarray holds has dimensions of these names in any order, of which only time must be there. A
table of pandas is one series, and so is each of a list of tables: columns go by their names.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from burstcast.arrays import FloatArray, float_array, is_known
from burstcast.data.named_arrays import AXES, NamedArrays
from burstcast.data.tables import column_names, frame_run
from burstcast.data.times import TIME


def as_series(data: Any, what: str = "the series") -> FloatArray:
    """Series of a user as an array of the one layout, finite and contiguous.

    ``data``: An array of NumPy, or what can be made one, of shape ``(series, time, component)``; a
    list of tables; or an array or a data set of xarray.
    """
    if hasattr(data, "dims"):
        arrays = NamedArrays(what, data)
        arrays.check_rising()
        data = arrays.states(list(arrays.columns))
    data = [data] if isinstance(data, pd.DataFrame) else data
    if isinstance(data, list | tuple):
        _check_equal_lengths(data, what)
        if any(isinstance(one, pd.DataFrame) for one in data):
            data = [_of_table(what, one, data[0]) for one in data]
    series = np.ascontiguousarray(float_array(data, what))
    if np.ndim(data) != len(AXES):
        single = "series[np.newaxis]" if np.ndim(data) == 2 else "series[np.newaxis, :, np.newaxis]"
        hint = f": a single series is {single}" if np.ndim(data) < 3 else ""
        raise ValueError(f"{what} must be ({', '.join(AXES)}), not {np.shape(data)}{hint}")
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


def _of_table(what: str, table: Any, first: Any) -> FloatArray:
    """Columns of a table, in the order that the first one has them in."""
    names, others = ([*column_names(what, one)] for one in (first, table))
    if sorted(names) != sorted(others):
        raise ValueError(f"{what}: tables have the columns {names} and {others}")
    names = [name for name in names if name != TIME]
    columns = frame_run(what, table, names, "second").columns
    if TIME in columns and not (np.diff(columns[TIME]) > 0).all():
        raise ValueError(f"{what}: times must rise from each sample to the next")
    return np.stack([columns[name] for name in names], axis=1)


def _check_equal_lengths(data: Sequence[Any], what: str) -> None:
    lengths = [len(one) for one in data if hasattr(one, "__len__")]
    if other := [number for number, length in enumerate(lengths) if length != lengths[0]]:
        raise ValueError(
            f"{what} have unequal lengths: series 0 has {lengths[0]} samples, series {other[0]} "
            f"{lengths[other[0]]}; cut them to one length"
        )
