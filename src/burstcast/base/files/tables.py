"""Tables as CSV files: one header line, shortest exact numbers, empty = undefined."""

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from burstcast.base.files.atomic_files import atomic


def write_table(
    path: str | Path, table: pd.DataFrame, check: Callable[[], None] | None = None
) -> pd.DataFrame:
    """Write a table without its index; an undefined value (NaN, None, NA) is an empty cell.

    ``check``: See `atomic`.
    """
    if not table.columns.is_unique:
        raise ValueError(f"{path}: two columns share a name: {list(table.columns)}")
    text = table.to_csv(index=False, lineterminator="\n")
    read_back = _parse(text)
    for column in table.columns:
        if (
            not pd.api.types.is_numeric_dtype(table[column])  # truth values count as numeric
            and table[column].notna().any()
            and not pd.api.types.is_string_dtype(read_back[column])
        ):
            raise ValueError(f"{path}: the text in column {column} would be read as numbers")
    with atomic(path, check) as partial:
        partial.write_bytes(text.encode())
    return read_back


def read_table(path: str | Path) -> pd.DataFrame:
    """Read a table that `write_table` wrote; empty cells are missing.

    Numbers come back exactly: whole numbers as int64, or Int64 where cells are empty; others and
    columns without any value as float64; the rest is text.
    """
    try:
        return _parse(Path(path).read_text(encoding="utf-8"))
    except ValueError as error:
        raise ValueError(f"{path} is no table: {error}") from error


_WHOLE_NUMBER = r"-?\d{1,18}"
_NUMBER = r"-?(\d+(\.\d*)?([eE][+-]?\d+)?|inf)"


def _parse(text: str) -> pd.DataFrame:
    # types are found here: what pandas takes for a number, and how exactly, varies with its version
    cells = pd.read_csv(io.StringIO(text), dtype=str, keep_default_na=False, skip_blank_lines=False)
    return pd.DataFrame({name: _typed(cells[name]) for name in cells.columns})


def _typed(cells: "pd.Series[str]") -> "pd.Series[Any]":
    """Column of the simplest type that all of its cells can be read as."""
    empty = cells == ""
    values = cells[~empty]
    if empty.all():
        return pd.Series(np.nan, index=cells.index, dtype="float64")
    if values.str.fullmatch(_WHOLE_NUMBER).all():
        return _with_gaps(values.astype("int64"), cells, "Int64")
    if values.str.fullmatch(_NUMBER).all():
        return _with_gaps(values.astype("float64"), cells, "float64")
    if values.isin(["True", "False"]).all():
        return _with_gaps(values == "True", cells, "boolean")
    return _with_gaps(values, cells, "str")


def _with_gaps(
    values: "pd.Series[Any]", cells: "pd.Series[str]", type_with_gaps: Any
) -> "pd.Series[Any]":
    """Values put back where they come from; the rest is missing."""
    if len(values) == len(cells):
        return values
    result: pd.Series[Any] = values.astype(type_with_gaps).reindex(cells.index)
    return result
