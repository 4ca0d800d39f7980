"""Tables of the workflow as CSV files: one header line, shortest exact numbers, empty = undefined.

Apart from `burstcast_workflow.storage` because few scripts need pandas, which is slow to import.
"""

import io
from pathlib import Path
from typing import Any

import pandas as pd

from burstcast_workflow.storage import write_text


def write_table(path: str | Path, table: pd.DataFrame) -> None:
    """Write a table without its index; an undefined value (NaN, None, NA) is an empty cell.

    Raises
    ------
    ValueError
        If two columns share a name, or if a column of text would be read back as numbers.
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
    write_text(path, text)


def read_table(path: str | Path) -> pd.DataFrame:
    """Read a table that `write_table` wrote.

    Numbers come back exactly. Whole numbers are int64, or Int64 where cells are empty; other
    numbers and columns without any value are float64; the rest is text. Empty cells are missing.
    """
    return _parse(Path(path).read_text(encoding="utf-8"))


def _parse(text: str) -> pd.DataFrame:
    table = pd.read_csv(
        io.StringIO(text),
        keep_default_na=False,
        na_values=[""],
        float_precision="round_trip",
        dtype_backend="numpy_nullable",
    )
    return pd.DataFrame(
        {column: _plain(table[column]) for column in table.columns}, columns=table.columns
    )


def _plain(column: "pd.Series[Any]") -> "pd.Series[Any]":
    """Column in numpy's own type wherever that loses nothing."""
    gaps = column.isna()
    if gaps.all():
        return column.astype("float64")
    if pd.api.types.is_bool_dtype(column.dtype):
        return column if gaps.any() else column.astype("bool")
    if pd.api.types.is_integer_dtype(column.dtype):
        return column if gaps.any() else column.astype("int64")
    if pd.api.types.is_float_dtype(column.dtype):
        return column.astype("float64")
    return column.astype("str")
