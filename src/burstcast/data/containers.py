"""The one way from a user's container to single series: both doors of series take it first.

A single series is a table of pandas with one index, an array or a data set of xarray, the path of a
file, or an array. Frames of other libraries become tables of pandas; a table with outer index
levels, groups, dictionaries and generators are several series. Anything else is refused.
"""

from collections.abc import Iterator, Mapping, Sequence, ValuesView
from pathlib import Path
from typing import Any

import numpy as np

_TAKEN = (
    "an array (series, time, component), a table of pandas, what xarray holds, or a list of these"
)


def unpacked(data: Any, what: str) -> Any:
    """Single series of a container as a list; an array, or numbers in lists, as they are.

    ``what``: Name of the data for messages: "the series".
    """
    if isinstance(data, np.ndarray) and data.dtype.names:
        raise TypeError(
            f"{what} must be a table of named columns, not records: give pd.DataFrame(records), "
            f"without columns that are no components"
        )
    if isinstance(data, np.ndarray | str | Path):
        return [data] if isinstance(data, str | Path) else data
    if is_labelled(data):
        return list(_parts(data, what))
    if _is_grouped(data):
        return list(_groups(data, what))
    if isinstance(data, Mapping):
        return _listed(_values(data, what), what)
    if (frame := as_pandas(data)) is not None:
        return list(_parts(frame, what))
    if isinstance(data, set | frozenset):
        raise TypeError(f"{what} must be in an order, which a {type(data).__name__} has not")
    if isinstance(data, list | tuple | Iterator | ValuesView):
        return _listed(list(data), what)
    if not hasattr(data, "__array__") and not isinstance(data, Sequence):
        raise TypeError(f"{what} must be {_TAKEN}, not a {type(data).__name__}")
    return data


def is_labelled(data: Any) -> bool:
    """Whether it is of xarray or of pandas, which take half a second to load."""
    return hasattr(data, "dims") or hasattr(data, "iloc")


def as_pandas(data: Any) -> Any | None:
    """Table of pandas with the columns of a frame of another library; None if it is no frame.

    Frames of polars and pyarrow have columns that NumPy reads; those of Dask are computed.
    """
    names = getattr(data, "column_names", None) or getattr(data, "columns", None)
    if names is None or isinstance(data, np.ndarray) or not hasattr(type(data), "__getitem__"):
        return None
    import pandas as pd

    if isinstance(data, pd.DataFrame | pd.Series):
        return data
    if hasattr(getattr(data, "schema", None), "pandas_metadata"):  # of pyarrow, with its index
        made = data.to_pandas()
        return made if isinstance(made, pd.DataFrame) else None
    name = f"{type(data).__module__.partition('.')[0]}.{type(data).__name__}"
    try:
        if hasattr(data, "compute"):
            computed = data.compute()
            if isinstance(computed, pd.DataFrame):
                return computed
        names = list(map(str, names))
        return pd.DataFrame({column: np.asarray(data[column]) for column in names})
    except Exception as error:
        raise TypeError(
            f"a {name} is no table that is understood: convert it to a DataFrame of pandas first "
            f"(.to_pandas(), or .collect().to_pandas() of a lazy one)"
        ) from error


def _parts(data: Any, what: str) -> Iterator[Any]:
    """Series of a table or an array: one for each entry of the outer levels of an index."""
    if hasattr(data, "compute") and hasattr(data, "npartitions"):  # of Dask
        data = as_pandas(data)
    if hasattr(data, "dims"):
        if not hasattr(data, "coords") or hasattr(data, "children"):
            raise TypeError(f"{what} must be {_TAKEN}, not a {type(data).__name__} of xarray")
        yield data
        return
    table = data.to_frame() if hasattr(data, "to_frame") and data.ndim == 1 else data
    if table.index.nlevels == 1:
        yield table
        return
    outer = list(range(table.index.nlevels - 1))
    _check_outer_levels(table.index, what)
    for _, part in table.groupby(level=outer, sort=False):
        yield part.droplevel(outer)


def _check_outer_levels(index: Any, what: str) -> None:
    """Check that outer levels tell runs apart, and are not the times of the rows."""
    runs = index.droplevel(-1)
    number, longest = runs.nunique(), int(runs.value_counts().max())
    has_times = "time" in runs.names
    if has_times or (number > longest and not _is_clock(index.get_level_values(-1))):
        level = "is called time" if has_times else f"has {number} entries"
        raise ValueError(
            f"{what} are a table whose outer index level {level}, of {longest} rows at most: outer "
            f"levels tell runs apart, and the last one has the times; "
            f"table.swaplevel().sort_index() exchanges two levels, and a list of tables, one for "
            f"each run, needs none"
        )


def _is_clock(level: Any) -> bool:
    """Whether a level of an index has times, and not just numbers of rows or runs."""
    import pandas as pd

    is_date = isinstance(level, pd.DatetimeIndex | pd.TimedeltaIndex | pd.PeriodIndex)
    is_fraction = level.dtype.kind == "f" and bool((level.to_numpy() % 1 != 0).any())
    return level.name == "time" or is_date or is_fraction


def _is_grouped(data: Any) -> bool:
    """Whether it is the result of ``groupby`` of pandas or polars, pairs of a key and a table."""
    names = ("DataFrameGroupBy", "SeriesGroupBy", "GroupBy")
    return type(data).__name__ in names and hasattr(data, "__iter__")


def _groups(data: Any, what: str) -> Iterator[Any]:
    """Tables of groups, without the columns that they were grouped by."""
    keys = getattr(data, "keys", getattr(data, "by", None))
    listed = keys if isinstance(keys, list | tuple) else [keys]
    if len(listed) == 1 and isinstance(listed[0], list | tuple):
        listed = listed[0]
    named = [getattr(key, "key", key) for key in listed]
    groups = list(data)
    if hasattr(data, "maintain_order") and not data.maintain_order:
        # polars has groups in another order each time
        groups.sort(key=lambda pair: [(value is None, value) for value in pair[0]])
    for _, part in groups:
        table = as_pandas(part) if not hasattr(part, "iloc") else part
        if table is None:
            raise TypeError(f"{what} must be {_TAKEN}, not groups of {type(part).__name__}")
        table = table.to_frame() if table.ndim == 1 else table
        columns = [name for name in named if isinstance(name, str) and name in table.columns]
        yield from _parts(table.drop(columns=columns), what)


def _values(data: Mapping[Any, Any], what: str) -> Sequence[Any]:
    """Series of a dictionary; columns by their names are none."""
    values = list(data.values())
    is_column = (
        getattr(value, "ndim", 2) < 2 if _is_table(value) else np.ndim(value) < 2
        for value in values
    )
    if any(is_column):
        raise TypeError(
            f"{what} are a dictionary of columns: one table of them is pd.DataFrame(...); a "
            f"dictionary of tables, or of arrays (time, component), is several series, and a list "
            f"of columns is several series of one component"
        )
    return values


def _is_table(value: Any) -> bool:
    return is_labelled(value) or isinstance(value, str | Path) or as_pandas(value) is not None


def _listed(data: Sequence[Any], what: str) -> list[Any]:
    """Series of the entries of a list, which may be tables of several series themselves."""
    series: list[Any] = []
    for given in data:
        is_pair = isinstance(given, tuple) and len(given) == 2 and _is_table(given[1])
        entry = given[1] if is_pair else given  # list(table.groupby("run")) has pairs
        if _is_table(entry) or _is_grouped(entry):
            series += unpacked(entry, what)
        elif (
            entry is None
            or isinstance(entry, Mapping | set | frozenset | Iterator)
            or (isinstance(entry, list | tuple) and any(map(_is_table, entry)))
        ):
            several = " of tables" if isinstance(entry, list | tuple) else ""
            raise TypeError(
                f"each of {what} must be an array (time, component), a table of pandas or what "
                f"xarray holds, not a {type(entry).__name__}{several}"
            )
        else:
            series.append(entry)
    return series
