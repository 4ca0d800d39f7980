"""Files of measured series: CSV, Parquet, NetCDF and NumPy's .npy.

A file is a table of numbers with a header and a column ``time``, or arrays whose axes are called
series, time and component. Anything else is refused with the row, the column and what to do:
nothing is shifted, filled or guessed. What has to be done before is pandas (docs/data_recipes.md).
"""

import csv
import io
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import netCDF4
import numpy as np
import pandas as pd
import scipy

from burstcast.arrays import FloatArray, float_array
from burstcast.data.measured_data import Run
from burstcast.data.times import TIME, is_number, moments_in, times_of, times_since

AXES = ("series", "time", "component")
"""Names of the axes of an array, and their order where they have no names."""

T = TypeVar("T")
RECIPES = "docs/data_recipes.md has recipes"


class Content(NamedTuple):
    """Columns of a file, and how they are read."""

    names: list[str]  # without ``time``
    has_time: bool  # whether there are times, which tables must have
    read: Callable[[Sequence[str], str | None], list[Run]]  # by names, with the unit of dates


def content_of(path: str) -> Content:
    """What a file has; no value is read."""
    suffix = Path(path).suffix.lower()
    if suffix not in _READERS:
        raise ValueError(
            f"{path}: files of series end in {', '.join(_READERS)}; convert others with pandas or "
            f"SciPy ({RECIPES})"
        )
    return _told(path, lambda: _READERS[suffix](path))


def read_runs(path: str, names: Sequence[str], unit: str | None = None) -> list[Run]:
    """Runs of a file: its series, each with some columns, and with its times if there are any.

    ``unit``: Unit of dates; None where times are numbers.
    """
    content = content_of(path)
    return _told(path, lambda: content.read(names, unit))


def _told(path: str, read: Callable[[], T]) -> T:
    """Result of a reader, whose errors name the file."""
    try:
        return read()
    except UnicodeError as error:
        raise ValueError(f"{path} is not written in UTF-8: save it so ({error})") from error
    except FileNotFoundError:
        raise ValueError(f"{path}: there is no such file, seen from {Path.cwd()}") from None
    except Exception as error:  # whatever the libraries of the formats raise
        text = str(error)
        raise ValueError(
            text if text.startswith(path) else f"{path} cannot be read: {text}"
        ) from error


# -- tables ----------------------------------------------------------------------------------------


def _csv(path: str) -> Content:
    with open(path, encoding="utf-8-sig", newline="") as file:
        before, line = 0, file.readline()
        while line.startswith("#") or (line and not line.strip()):
            before, line = before + 1, file.readline()
    names = _header(path, line.rstrip("\r\n"), before + 1)
    return Content(
        [name for name in names if name != TIME],
        TIME in names,
        lambda wanted, unit: [_csv_run(path, names, before + 1, wanted, unit)],
    )


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
    for column, name in enumerate(names):
        if not name:
            index = (
                f": pandas writes an index so; call it {TIME} (index.name)" if not column else ""
            )
            raise ValueError(f"{place}: column {column + 1} has no name{index}")
        if names.count(name) > 1:
            raise ValueError(f"{path} has {names.count(name)} columns that are called {name!r}")
    return names


def _csv_run(
    path: str, names: list[str], header: int, wanted: Sequence[str], unit: str | None
) -> Run:
    """Columns of a table.

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
    wrong = (commas != len(names) - 1) | (np.diff(ends, prepend=-1) == 1)
    if wrong.any():
        row = int(wrong.argmax())
        fields = commas[row] + 1 if np.diff(ends, prepend=-1)[row] > 1 else "no"
        raise ValueError(
            f"{path}, line {header + row + 1} has {fields} fields, but the header has {len(names)}"
        )
    if b'"' in body:
        row = body[: body.index(b'"')].count(b"\n")
        raise ValueError(
            f"{path}, line {header + row + 1} has a quotation mark: leave columns of text out, and "
            f"write times and numbers without"
        )
    first = body[: ends[0]].decode().split(",")
    dated = TIME in names and not is_number(first[names.index(TIME)])
    columns = [*wanted, *([TIME] if TIME in names else [])]

    def table(**kinds: Any) -> pd.DataFrame:
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

    try:
        if any(word in body for word in _TRUTHS):
            raise ValueError("pandas takes truths for numbers")
        numbers = dict.fromkeys(columns, "float64")
        if dated:
            numbers[TIME] = "str"
        read = table(dtype=numbers, keep_default_na=not dated, na_values=sorted(_GAPS))
        found = {name: read[name].to_numpy() for name in columns if numbers[name] != "str"}
    except ValueError:  # a field that is no number, whose place pandas does not tell
        read, found = table(dtype=str, keep_default_na=False), {}
        for name in wanted:
            found[name] = _numbers(path, name, read[name].tolist(), header)
    if TIME in columns and TIME not in found:
        found[TIME] = _times(path, read[TIME].fillna("").str.strip().tolist(), unit, header)
    return Run(path, found)


_GAPS = frozenset({"", "nan", "NaN", "NA", "N/A", "n/a", "<NA>", "null", "NULL", "None", "#N/A"})
"""How tables write that there is no number."""
_TRUTHS = (b"rue", b"RUE", b"alse", b"ALSE")


def _numbers(path: str, name: str, texts: Sequence[str], header: int) -> FloatArray:
    values = []
    for line, text in enumerate(map(str.strip, texts), header + 1):
        if text in _GAPS:
            values.append(np.nan)
        elif is_number(text):
            values.append(float(text))
        else:
            raise ValueError(
                f"{path}, line {line}: column {name!r} has {text!r}, which is no number; gaps are "
                f"nan, or empty"
            )
    return np.array(values)


def _times(path: str, texts: Sequence[str], unit: str | None, header: int) -> FloatArray:
    try:
        return times_of(texts, unit)
    except ValueError as error:
        row, _, rest = str(error).partition("] ")
        line = header + int(row.removeprefix("[")) + 1
        raise ValueError(f"{path}, line {line}: column {TIME!r} {rest}") from None


def _parquet(path: str) -> Content:
    try:
        table = pd.read_parquet(path)
    except ImportError:
        raise ValueError(
            f"{path}: reading Parquet takes pyarrow, which is not installed: install it, or "
            f"convert the file to CSV or NetCDF"
        ) from None
    names = list(map(str, frame_with_time(table).columns))
    return Content(
        [name for name in names if name != TIME],
        TIME in names,
        lambda wanted, unit: [run_of_frame(path, table, wanted, unit)],
    )


def frame_with_time(frame: pd.DataFrame) -> pd.DataFrame:
    """A table whose index, if it is called ``time``, is a column."""
    return frame.reset_index() if frame.index.name == TIME else frame


def run_of_frame(source: str, frame: pd.DataFrame, wanted: Sequence[str], unit: str | None) -> Run:
    """Columns of a table of pandas, with its times; rows are counted from 1 in messages."""
    table = frame_with_time(frame)
    if not len(table):
        raise ValueError(f"{source} has no rows")
    names = list(map(str, table.columns))
    table = table.set_axis(names, axis=1)
    columns = {}
    for name in (*wanted, *([TIME] if TIME in names else [])):
        if names.count(name) > 1:
            raise ValueError(f"{source} has {names.count(name)} columns that are called {name!r}")
        column = table[name]
        if name == TIME and pd.api.types.is_datetime64_any_dtype(column):
            if unit is None:
                raise ValueError(
                    f"{source}: {TIME!r} has dates, but the time step has no unit: write it with "
                    f"one, such as 5 minutes"
                )
            columns[name] = moments_in(pd.DatetimeIndex(column), unit)
            continue
        if not pd.api.types.is_numeric_dtype(column) or pd.api.types.is_complex_dtype(column):
            raise ValueError(f"{source}: column {name!r} has no numbers, but {column.dtype}")
        columns[name] = column.to_numpy(dtype=np.float64, na_value=np.nan)
    return Run(source, columns)


# -- arrays ----------------------------------------------------------------------------------------


def _npy(path: str) -> Content:
    with open(path, "rb") as file:
        array = np.load(file, allow_pickle=False)
        if file.read(1):
            raise ValueError("it has more after its first array: a .npy file holds one")
    return _array_content(path, array, None)


def _array_content(path: str, array: Any, names: Sequence[str] | None) -> Content:
    """Content of an array of the one layout; components without names are c1, c2, ..."""
    values = float_array(array, path)
    if values.ndim != len(AXES) or not values.size:
        raise ValueError(
            f"{path} has the shape {values.shape}; expected is ({', '.join(AXES)}), such as "
            f"array.reshape(1, -1, 1) of a single signal"
        )
    known = list(names or (f"c{number}" for number in range(1, values.shape[2] + 1)))

    def read(wanted: Sequence[str], unit: str | None) -> list[Run]:
        return [
            Run(where, {name: one[:, known.index(name)] for name in wanted})
            for where, one in zip(_series_names(path, len(values)), values, strict=True)
        ]

    return Content(known, False, read)


def _series_names(path: str, count: int) -> list[str]:
    return [path] if count == 1 else [f"{path}, series {row}" for row in range(1, count + 1)]


def _netcdf(path: str) -> Content:
    with open(path, "rb") as content:
        is_classic = content.read(3) == b"CDF"
    if is_classic:
        _check_complete(path)  # first: the library may crash when it opens a damaged one
    with netCDF4.Dataset(path, "r") as file:
        columns: dict[str, tuple[str, int]] = {}  # variable, and place along its components
        for name, variable in file.variables.items():
            axes = set(variable.dimensions)
            if name in AXES or not {TIME} <= axes <= set(AXES):
                continue
            labels = _labels(file, variable) if "component" in axes else [name]
            for number, label in enumerate(labels):
                if label in columns:
                    raise ValueError(
                        f"{path} has {label!r} in {columns[label][0]} and in {name}: keep one of "
                        f"them in the file"
                    )
                columns[label] = name, number
        if not columns:
            listed = ", ".join(
                f"{name} ({', '.join(one.dimensions)})" for name, one in file.variables.items()
            )
            raise ValueError(
                f"{path} has no variable with the dimensions {', '.join(AXES)} or some of them; it "
                f"has {listed or 'none'}: rename them (.rename of xarray)"
            )
        has_time = TIME in file.variables
    return Content(
        list(columns),
        has_time,
        lambda wanted, unit: _netcdf_runs(path, {name: columns[name] for name in wanted}, unit),
    )


def _labels(file: netCDF4.Dataset, variable: Any) -> list[str]:
    """Names of the components of a variable."""
    count = variable.shape[variable.dimensions.index("component")]
    if "component" not in file.variables:
        return [f"c{number}" for number in range(1, count + 1)]
    labels = file.variables["component"]
    if labels.dtype is str:
        return list(map(str, labels[...]))
    if np.dtype(labels.dtype).kind == "S":
        return [str(one) for one in np.atleast_1d(netCDF4.chartostring(labels[...]))]
    return [f"c{value:g}" for value in labels[...]]


def _netcdf_runs(path: str, columns: Mapping[str, tuple[str, int]], unit: str | None) -> list[Run]:
    with netCDF4.Dataset(path, "r") as file:
        variables = dict.fromkeys(variable for variable, _ in columns.values())
        arrays = {name: _ordered(path, name, file[name]) for name in variables}
        read = {name: arrays[of][:, :, number] for name, (of, number) in columns.items()}
        if TIME in file.variables:
            read[TIME] = _time_of(path, file[TIME], unit)
    count = max(map(len, read.values()))
    for name, values in read.items():
        if len(values) not in (1, count):
            raise ValueError(f"{path}: {name} has {len(values)} series, others have {count}")
    return [
        Run(where, {name: values[min(row, len(values) - 1)] for name, values in read.items()})
        for row, where in enumerate(_series_names(path, count))
    ]


def _ordered(path: str, name: str, variable: Any) -> FloatArray:
    """Variable as ``(series, time, component)``, by the names of its dimensions; gaps are NaN."""
    if variable.dtype is str:  # the library crashes when it reads numbers of 16 bits
        raise ValueError(
            f"{path}, {name} is text, or has numbers of a type that NetCDF has not, such as "
            f"float16: write it as float64"
        )
    values = variable[...]
    numbers = float_array(np.ma.getdata(values), f"{path}, {name}")
    numbers = np.where(np.ma.getmaskarray(values), np.nan, numbers)
    if not numbers.size:
        raise ValueError(f"{path}, {name} is empty: its shape is {numbers.shape}")
    missing = [axis for axis in AXES if axis not in variable.dimensions]
    full = numbers.reshape(*numbers.shape, *[1] * len(missing))
    order = [*variable.dimensions, *missing]
    return full.transpose([order.index(axis) for axis in AXES])


def _time_of(path: str, variable: Any, unit: str | None) -> FloatArray:
    """Times ``(series or 1, time)`` of a file, in the unit of the time step if it has one."""
    values = _ordered(path, TIME, variable)[:, :, 0]
    units = str(getattr(variable, "units", ""))
    if unit is None or " since " not in units:
        return values
    try:
        return times_since(values, units, str(getattr(variable, "calendar", "standard")), unit)
    except ValueError as error:
        raise ValueError(f"{path}: {TIME!r} {error}") from None


def _check_complete(path: str) -> None:
    """Check that a classic NetCDF file has all its bytes: netCDF4 reads zeros for missing ones."""
    try:
        with scipy.io.netcdf_file(path):  # loaded here alone: it takes a while
            pass
    except Exception as error:  # its parser has no errors of its own
        raise ValueError(
            f"{path} is cut off, or is no classic NetCDF file of 32 or 64-bit offsets: copy it "
            f"again, or convert it (nccopy -k netCDF-4)"
        ) from error


_READERS = {".csv": _csv, ".parquet": _parquet, ".nc": _netcdf, ".npy": _npy}
