"""Tables as CSV files: one header line, shortest exact numbers, empty = undefined."""

import csv
import io
import math
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from burstcast.base.files.atomic_files import atomic

if TYPE_CHECKING:
    import pandas as pd


def write_table(
    path: str | Path, table: "pd.DataFrame", check: Callable[[], None] | None = None
) -> "pd.DataFrame":
    """Write a table without its index; an undefined value (NaN, None, NA) is an empty cell.

    ``check``: See `atomic`.
    """
    if not table.columns.is_unique:
        raise ValueError(f"{path}: two columns share a name: {list(table.columns)}")
    import pandas as pd  # jobs from the cache start without it

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


def read_table(path: str | Path) -> "pd.DataFrame":
    """Read a table that `write_table` wrote; empty cells are missing.

    Numbers come back exactly: whole numbers as int64, or Int64 where cells are empty; others and
    columns without any value as float64; the rest is text.
    """
    try:
        return _parse(Path(path).read_text(encoding="utf-8"))
    except (ValueError, csv.Error) as error:
        raise ValueError(f"{path} is no table: {error}") from error


_WHOLE_NUMBER = re.compile(r"-?\d{1,18}")
_NUMBER = re.compile(r"-?(\d+(\.\d*)?([eE][+-]?\d+)?|inf)")


def _parse(text: str) -> "pd.DataFrame":
    import pandas as pd

    # types are found here: what pandas takes for a number, and how exactly, varies with its version
    lines = csv.reader(io.StringIO(text), strict=True)
    if (names := next(lines, None)) is None:
        raise ValueError("it is empty")
    rows = [cells or [""] for cells in lines]  # an empty line is an empty cell of the only column
    if strange := [row for row, cells in enumerate(rows, 1) if len(cells) != len(names)]:
        raise ValueError(f"row {strange[0]} has another number of cells than the header")
    columns = zip(*rows, strict=True) if rows else [()] * len(names)
    return pd.DataFrame({name: _typed(cells) for name, cells in zip(names, columns, strict=True)})


def _typed(cells: Sequence[str]) -> "pd.Series[Any]":
    """Column of the simplest type that all of its cells can be read as."""
    import pandas as pd

    values = [*filter(None, cells)]
    full = len(values) == len(cells)
    if not values:
        return pd.Series([math.nan] * len(cells), dtype="float64")
    if all(map(_WHOLE_NUMBER.fullmatch, values)):
        return pd.Series(_read(cells, int), dtype="int64" if full else "Int64")
    if all(map(_NUMBER.fullmatch, values)):
        return pd.Series(_read(cells, float), dtype="float64")
    if {*values} <= {"True", "False"}:
        return pd.Series(_read(cells, "True".__eq__), dtype="bool" if full else "boolean")
    return pd.Series(_read(cells, str), dtype="str")


def _read(cells: Sequence[str], of_text: Callable[[str], object]) -> list[object]:
    return [of_text(cell) if cell else None for cell in cells]
