"""The door of tables: CSV, Parquet and DataFrames of pandas become runs by one check.

A table has numbers in named columns and a column, or an index, of times. An index of whole numbers
that rise in equal steps counts rows; any other index is refused. pandas reads CSV; what it would
fill or guess in one is refused before, with the line.
"""

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.data.measured_data import Content, Run
from burstcast.data.series_layout import LabelledRun
from burstcast.data.times import TIME, TimesError, is_dated, is_number, times_in

if TYPE_CHECKING:
    import pandas as pd

RECIPES = "docs/data_recipes.md has recipes"

_GAPS = frozenset({"", "nan", "NaN", "NA", "N/A", "n/a", "<NA>", "null", "NULL", "None", "#N/A"})
"""How tables write that there is no number."""
_TRUTHS = (b"rue", b"RUE", b"alse", b"ALSE")


def frame_content(source: str, frame: "pd.DataFrame") -> Content:
    """What a table of pandas has."""
    frame = with_clock(source, frame)
    names = _with_time(source, column_names(source, frame))
    return Content(source, names, lambda wanted, unit: [frame_run(source, frame, wanted, unit)])


def csv_content(path: str) -> Content:
    """What a table in a file has; only its header is read."""
    with open(path, encoding="utf-8-sig", newline="") as file:
        header, line = 1, file.readline()
        while line.startswith("#") or (line and not line.strip()):
            header, line = header + 1, file.readline()
    if line.lower().startswith("sep="):
        raise ValueError(
            f"{path}, line {header} is {line.strip()!r}, which Excel writes to name the separator: "
            f"remove this line"
        )
    names = _header(path, line.rstrip("\r\n"), header)

    def read(wanted: Sequence[str], unit: str | None) -> list[Run]:
        frame = _csv_frame(path, names, header, [*wanted, TIME])
        return [frame_run(path, frame, wanted, unit, header + 1)]

    return Content(path, _with_time(path, names), read)


def column_names(source: str, frame: "pd.DataFrame") -> list[str]:
    """Names of columns, and of an index that is called ``time``."""
    if frame.columns.nlevels > 1:
        raise ValueError(
            f"{source} has columns of {frame.columns.nlevels} levels, such as "
            f"{frame.columns[0]!r}: name each column by one text "
            f"(table.columns = table.columns.map('_'.join)), or give a list of tables"
        )
    names = list(map(str, frame.columns))
    return _distinct(source, [TIME, *names] if frame.index.name == TIME else names)


def with_clock(source: str, frame: "pd.DataFrame") -> "pd.DataFrame":
    """A table whose index is called ``time`` if it has times, or counts rows if it has none.

    Raises ValueError for an index that is neither, such as one with holes.
    """
    import pandas as pd  # planning reads no tables

    index = frame.index
    if index.name == TIME or not len(frame):
        return frame
    if index.nlevels > 1:
        raise ValueError(
            f"{source} has an index of {index.nlevels} levels: give a list of series, "
            f"[table.droplevel(0) for _, table in table.groupby(level=0)]"
        )
    if isinstance(index, pd.DatetimeIndex | pd.TimedeltaIndex | pd.PeriodIndex):
        return frame.rename_axis(index=TIME)
    timed = TIME in frame.columns
    if not timed:
        _check_dates_are_called_time(source, frame)
    if pd.api.types.is_numeric_dtype(index.dtype) and index.dtype.kind not in "bc":
        numbers = index.to_numpy(dtype=np.float64, na_value=np.nan)
        if not timed and np.isfinite(numbers).all() and (numbers % 1 != 0).any():
            return frame.rename_axis(index=TIME)  # times in the unit of the time step
        if not timed:
            _check_row_numbers(source, numbers)
        return frame
    if timed:
        return frame
    try:
        times_in(index, "second")
    except TimesError as error:
        raise ValueError(
            f"{source}: its index is neither times nor row numbers, since it {error}; if it means "
            f"nothing, leave it out (reset_index(drop=True))"
        ) from None
    return frame.rename_axis(index=TIME)


def _check_dates_are_called_time(source: str, frame: "pd.DataFrame") -> None:
    """Check that no column has dates, in a table without a column or an index of times."""
    import pandas as pd

    for place, name in enumerate(frame.columns):
        column = frame.iloc[:, place]
        if pd.api.types.is_numeric_dtype(column.dtype):
            continue
        try:
            dated = is_dated(column.head(1)) and len(times_in(column.head(1), "second"))
        except TimesError:
            continue
        if dated:
            raise ValueError(
                f"{source}: column {name!r} has no numbers, but dates: if it is the clock, call it "
                f"{TIME!r} (table.rename(columns={{{name!r}: {TIME!r}}})), or else leave it out"
            )


def _check_row_numbers(source: str, numbers: FloatArray) -> None:
    """Check that an index of whole numbers counts rows, each or every n-th, without holes."""
    steps = np.diff(numbers)
    if not len(steps) or (steps[0] > 0 and (steps == steps[0]).all()):
        return
    if not np.isfinite(numbers).all():
        raise ValueError(f"{source}: its index has no number in some rows: leave it out, or fill")
    if (steps <= 0).all():
        raise ValueError(
            f"{source}: its index falls, the last row first, but times must rise: reverse the "
            f"table ([::-1])"
        )
    if (steps <= 0).any():
        row = int((steps <= 0).argmax())
        raise ValueError(
            f"{source}: its index goes from {numbers[row]:g} to {numbers[row + 1]:g} in row "
            f"{row + 2}, as where tables were joined: give a list of series, or "
            f"pd.concat(tables, keys=range(n)); if all rows follow each other, "
            f"reset_index(drop=True)"
        )
    typical = float(np.median(steps))
    row = int((steps != typical).argmax())
    raise ValueError(
        f"{source}: rows are missing between {numbers[row]:g} and {numbers[row + 1]:g} of its "
        f"index, which rises by {typical:g} else ({int((steps != typical).sum())} such places): "
        f"give the runs between gaps as a list of series; if no row is missing, "
        f"reset_index(drop=True)"
    )


def frame_run(
    source: str,
    frame: "pd.DataFrame",
    wanted: Sequence[str],
    unit: str | None,
    first_line: int | None = None,
) -> Run:
    """Columns of a table, and its times if it has any: the one check of all tables.

    ``unit``: Unit of dates; None where times are numbers. ``first_line``: Line of a file that the
    first row stands in; without it, messages count rows from 1.
    """
    import pandas as pd

    if not len(frame):
        raise ValueError(f"{source} has no rows")
    names = column_names(source, frame)
    table = (frame.reset_index() if frame.index.name == TIME else frame).set_axis(names, axis=1)
    columns = {}
    for name in dict.fromkeys((*wanted, *([TIME] if TIME in names else []))):
        column, kind = table[name], table.dtypes[name]
        if name == TIME:
            try:
                columns[name] = times_in(column, unit)
            except TimesError as error:
                place = _place(error.row, first_line)
                raise ValueError(f"{source}{place}: column {TIME!r} {error}") from None
        elif not pd.api.types.is_numeric_dtype(kind) or kind.kind in "bc":
            texts = kind.kind in "OUT" or str(kind) in ("str", "string")
            advice = "; if all are numbers, table.astype(float)" if texts else ""
            raise ValueError(f"{source}: column {name!r} has no numbers, but {kind}{advice}")
        else:
            columns[name] = column.to_numpy(dtype=np.float64, na_value=np.nan)
    return Run(source, columns)


def labelled_run(source: str, frame: "pd.DataFrame") -> LabelledRun:
    """Rows of a table with the names of its columns; its times are a column or an index."""
    table = with_clock(source, frame)
    names = column_names(source, table)
    run = frame_run(source, table, names, "second")
    columns = dict(run.columns)
    times, labels = columns.pop(TIME, None), tuple(name for name in names if name != TIME)
    given: Any = table.index if table.index.name == TIME else table.get(TIME)
    dated = times is not None and is_dated(given)
    if not labels:
        raise ValueError(f"{source} has no column beside {TIME!r}")
    states = np.stack([columns[name] for name in labels], axis=1)
    return LabelledRun(labels, states, times, dated)


def _place(row: int | None, first_line: int | None) -> str:
    if row is None:
        return ""
    return f", row {row + 1}" if first_line is None else f", line {first_line + row}"


def _distinct(source: str, names: list[str]) -> list[str]:
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"{source} has {names.count(name)} columns that are called {name!r}")
    return names


def _with_time(source: str, names: list[str]) -> list[str]:
    """Names of columns without ``time``, which must be there."""
    if TIME not in names:
        raise ValueError(
            f"{source} has no column {TIME!r}; its columns are {', '.join(names)}: rename one of "
            f"them, or add the times of the rows"
        )
    return [name for name in names if name != TIME]


def _header(path: str, line: str, number: int) -> list[str]:
    place = f"{path}, line {number}"
    if not line:
        raise ValueError(f"{path} is empty")
    names = [name.strip() for name in next(csv.reader([line], skipinitialspace=True))]
    if len(names) == 1 and any(mark in line for mark in ";\t "):
        raise ValueError(
            f"{place}: the header is {line!r}; fields are separated by commas. pandas reads other "
            f"tables (read_csv(sep=...)), and writes them so"
        )
    if all(is_number(name) for name in names):
        raise ValueError(
            f"{place} has numbers where the names of the columns are expected: write a header "
            f"({RECIPES})"
        )
    for name in names:
        if not name.isprintable():
            raise ValueError(
                f"{place}: the name of a column, {name!a}, has characters that are not seen, "
                f"such as a second byte-order mark (\\ufeff): remove them"
            )
    if "" in names:
        column = names.index("")
        index = f": pandas writes an index so; call it {TIME} (index.name)" if not column else ""
        raise ValueError(f"{place}: column {column + 1} has no name{index}")
    return _distinct(path, names)


def _csv_frame(path: str, names: list[str], header: int, columns: list[str]) -> "pd.DataFrame":
    """Columns of a table: numbers, and times as numbers or text.

    pandas reads numbers exactly, but fills rows that are too short: fields are counted here.
    """
    body = Path(path).read_bytes()
    body.decode("utf-8-sig")
    body = body.replace(b"\r\n", b"\n").replace(b"\r", b"\n").rstrip(b"\n ") + b"\n"
    body = body.split(b"\n", header)[header]
    if not body:
        raise ValueError(f"{path} has a header, but no rows")
    characters = np.frombuffer(body, np.uint8)
    ends = np.flatnonzero(characters == ord("\n"))
    commas = np.diff(np.searchsorted(np.flatnonzero(characters == ord(",")), ends), prepend=0)
    empty = np.diff(ends, prepend=-1) == 1
    wrong = (commas != len(names) - 1) | empty
    if wrong.any():
        row = int(wrong.argmax())
        fields = "no" if empty[row] else commas[row] + 1
        raise ValueError(
            f"{path}{_place(row, header + 1)} has {fields} fields, but the header has {len(names)}"
        )
    if b'"' in body:
        row = body[: body.index(b'"')].count(b"\n")
        raise ValueError(
            f"{path}{_place(row, header + 1)} has a quotation mark: leave columns of text out, and "
            f"write times and numbers without"
        )

    import pandas as pd

    def table(**kinds: Any) -> "pd.DataFrame":
        read: pd.DataFrame = pd.read_csv(
            io.BytesIO(body),
            usecols=columns,
            header=None,
            names=names,
            index_col=False,
            skip_blank_lines=False,
            quoting=csv.QUOTE_NONE,
            **kinds,
        )
        return read

    dated = not is_number(body[: ends[0]].decode().split(",")[names.index(TIME)])
    kinds = dict.fromkeys(columns, "float64") | ({TIME: "str"} if dated else {})
    try:
        if any(word in body for word in _TRUTHS):
            raise ValueError("pandas takes truths for numbers")
        return table(dtype=kinds, keep_default_na=not dated, na_values=sorted(_GAPS))
    except ValueError:  # a field that is no number, whose place pandas does not tell
        read = table(dtype=str, keep_default_na=False)
        for name in (column for column in columns if column != TIME):
            read[name] = _numbers(path, name, read[name].tolist(), header + 1)
        return read


def _numbers(path: str, name: str, texts: Sequence[str], first_line: int) -> FloatArray:
    values = []
    for row, text in enumerate(map(str.strip, texts)):
        if text not in _GAPS and not is_number(text):
            raise ValueError(
                f"{path}{_place(row, first_line)}: column {name!r} has {text!r}, which is no "
                f"number; gaps are nan, or empty"
            )
        values.append(np.nan if text in _GAPS else float(text))
    return np.array(values)
