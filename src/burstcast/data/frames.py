"""Tables of pandas and arrays of xarray as series, by the checks of a campaign's files."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from burstcast.arrays import FloatArray, float_array
from burstcast.data.measured_data import Blocks, Quantity, Run
from burstcast.data.records import check_regular, series_of_records
from burstcast.data.series_files import AXES, frame_with_time, run_of_frame
from burstcast.data.times import TIME, time_step_of
from burstcast.systems.measured import MeasuredSeries


def from_dataframe(
    frame: pd.DataFrame,
    time_step: float | str,
    components: Sequence[str] = (),
    *,
    block: float | None = None,
    gap: float = 0.0,
    cut_gaps: bool = False,
) -> FloatArray:
    """Series of a table with a column, or an index, ``time``, as a campaign reads them of a file.

    Parameters
    ----------
    frame
        Table of one record: numbers in equal steps of time.
    time_step
        Time between two rows; with a unit where times are dates: "5 minutes".
    components
        Columns, expressions of columns, or ``name = expression``; by default all columns.
    block, gap
        Length of each series, and time between two of them, in time units; None: one series.
    cut_gaps
        Whether missing rows and NaN cut the record into blocks; otherwise they are errors.

    Returns
    -------
    ``(series, time, component)``.

    Raises
    ------
    ValueError
        If the table is not one of numbers in equal steps of time: with the row and the column.

    Examples
    --------
    >>> times = pd.date_range("2020-01-01", periods=100, freq="h", name="time")
    >>> frame = pd.DataFrame({"load": np.sin(np.arange(100.0))}, index=times)
    >>> from_dataframe(frame, "1 hour", block=24).shape
    (4, 25, 1)
    """
    if not isinstance(frame, pd.DataFrame):
        raise TypeError(f"the table must be a DataFrame of pandas, not {type(frame).__name__}")
    step, unit = time_step_of(time_step)
    names = [str(name) for name in frame_with_time(frame).columns if name != TIME]
    quantities = list(map(Quantity, components or names))
    wanted = [name for one in quantities for name in one.columns(names)]
    run = run_of_frame("the table", frame, list(dict.fromkeys(wanted)), unit)
    if TIME not in run.columns:
        raise ValueError(f"the table has no column {TIME!r}; its columns are {', '.join(names)}")
    if cut_gaps and block is None:
        raise ValueError("cut_gaps needs block, the length of the series")
    space = MeasuredSeries([one.name for one in quantities], quantities[0].name)
    blocks = None if block is None else Blocks.of(block, gap, step)
    return series_of_records([run], space, quantities, (), step, cut_gaps, blocks).states


def from_xarray(array: Any, time_step: float | None = None) -> FloatArray:
    """Series of an array or a data set of xarray, by the names of its dimensions.

    Parameters
    ----------
    array
        Of dimensions series, time and component in any order; a missing series is one series. The
        variables of a data set are its components.
    time_step
        Time between two samples, in the unit of the coordinate ``time``. None: its first step.

    Returns
    -------
    ``(series, time, component)``, components in the order of the array.

    Raises
    ------
    ValueError
        If dimensions have other names, or the times are not in equal rising steps.
    """
    whole = array.to_dataarray("component") if hasattr(array, "data_vars") else array
    names = list(map(str, whole.dims))
    if "series" not in names:
        whole = whole.expand_dims("series")
    if set(whole.dims) != set(AXES):
        raise ValueError(
            f"the array must have the dimensions {', '.join(AXES)}, not {', '.join(names)}: rename "
            f"them (.rename), or add the missing ones (.expand_dims)"
        )
    values = float_array(whole.transpose(*AXES).to_numpy(), "the array")
    if TIME in whole.coords:
        time = np.asarray(whole.coords[TIME].to_numpy())
        if time.dtype.kind == "M":
            time = (time - time[0]) / np.timedelta64(1, "s")
        elif time.dtype.kind == "O":
            raise ValueError("the times are of another calendar: give numbers (decode_times=False)")
        time = time.astype(np.float64)
        if len(time) > 1:
            step = time_step if time_step is not None else float(time[1] - time[0])
            check_regular(Run("the array", {TIME: time}), step)
    return np.ascontiguousarray(values)
