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

from burstcast.arrays import AXES, FloatArray, float_array, is_known


def as_series(data: Any, what: str = "the series") -> FloatArray:
    """Copy series of a user into an array of the one layout, finite and contiguous.

    ``data``: An array of NumPy, or what can be made one, of shape ``(series, time, component)``; a
    table or a list of tables; or an array or a data set of xarray.
    """
    # pandas takes half a second to load: only where there is something of it
    if hasattr(data, "dims"):
        from burstcast.data.named_arrays import NamedArrays

        data = NamedArrays(what, data).rising_states()
    data = [data] if hasattr(data, "iloc") else data
    if isinstance(data, list | tuple):
        _check_equal_lengths(data, what)
        if any(hasattr(one, "iloc") for one in data):
            from burstcast.data.tables import rising_rows

            data = rising_rows(what, data)
    series = np.array(float_array(data, what), order="C")
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


def _check_equal_lengths(data: Sequence[Any], what: str) -> None:
    lengths = [len(one) for one in data if hasattr(one, "__len__")]
    if other := [number for number, length in enumerate(lengths) if length != lengths[0]]:
        raise ValueError(
            f"{what} have unequal lengths: series 0 has {lengths[0]} samples, series {other[0]} "
            f"{lengths[other[0]]}; cut them to one length"
        )
