"""The one way from a user's container to single series: both doors of series take it first.

A single series is a table of pandas with one index, an array or a data set of xarray, the path of a
file, or an array. Frames of other libraries become tables of pandas; a table with outer index
levels, groups, dictionaries and generators are several series. Anything else is refused.
"""

from collections.abc import Iterator, Mapping, Sequence
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
    if isinstance(data, list | tuple | Iterator):
        return _listed(list(data), what)
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
    for _, part in table.groupby(level=outer, sort=False):
        yield part.droplevel(outer)


def _is_grouped(data: Any) -> bool:
    """Whether it is the result of ``groupby`` of pandas or polars, pairs of a key and a table."""
    return type(data).__name__ in ("DataFrameGroupBy", "GroupBy") and hasattr(data, "__iter__")


def _groups(data: Any, what: str) -> Iterator[Any]:
    """Tables of groups, without the columns that they were grouped by."""
    keys = getattr(data, "keys", getattr(data, "by", None))
    named = [keys] if isinstance(keys, str) else keys if isinstance(keys, list) else []
    for _, part in data:
        table = as_pandas(part) if not hasattr(part, "iloc") else part
        if table is None:
            raise TypeError(f"{what} must be {_TAKEN}, not groups of {type(part).__name__}")
        columns = [name for name in named if isinstance(name, str) and name in table.columns]
        yield from _parts(table.drop(columns=columns), what)


def _values(data: Mapping[Any, Any], what: str) -> Sequence[Any]:
    """Series of a dictionary; columns by their names are none."""
    values = list(data.values())
    if any(np.ndim(value) < 2 for value in values if not _is_table(value)):
        raise TypeError(
            f"{what} are a dictionary of columns: one table of them is pd.DataFrame(...); a "
            f"dictionary of tables, or of arrays (time, component), is several series"
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
        elif isinstance(entry, Mapping | set | frozenset | Iterator):
            raise TypeError(
                f"each of {what} must be an array (time, component), a table of pandas or what "
                f"xarray holds, not a {type(entry).__name__}"
            )
        else:
            series.append(entry)
    return series
