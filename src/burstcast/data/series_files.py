"""Files that measured series come in: CSV, Parquet, NetCDF, HDF5 and NumPy's.

All of them are read into runs of named columns (`burstcast.data.measured_data.Run`).
"""

import csv
import itertools
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import netCDF4
import numpy as np
import numpy.typing as npt
import pandas as pd
from scipy.io import netcdf_file

from burstcast.arrays import float_array
from burstcast.data.measured_data import Run
from burstcast.data.time_stamps import TimeStamps
from burstcast.discovery import suggestion

Array = npt.NDArray[np.float64]
Needed = Callable[[Sequence[str]], Sequence[str]]
"""Selects the required columns from the available ones; raises `ValueError` if one is missing."""

TABLES = (".csv", ".tsv", ".txt", ".dat", ".parquet")
NETCDF = (".nc", ".nc4", ".cdf", ".h5", ".hdf5", ".hdf")
NUMPY = (".npy", ".npz")
AXES = ("series", "time", "component")
_SYNONYMS = {
    **dict.fromkeys(("realisation", "realization", "run", "member", "trial", "ensemble"), "series"),
    **dict.fromkeys(("t", "times", "step", "sample"), "time"),
    **dict.fromkeys(("components", "variable", "feature", "channel", "state"), "component"),
}

_GAPS = frozenset({"", "nan", "na", "n/a", "#n/a", "<na>", "null", "none"})
"""How tables write that there is no number, in small letters."""
_ERROR_OF_EXCEL = re.compile(r"#([^\s,]+[!?]|N/A|NV\b|N/D|#*[,\t]|#{2,} +[-+.\d])", re.IGNORECASE)
"""Beginnings of rows that are no comments: #N/A, #DIV/0!, ########, in several languages."""
_DATE = re.compile(r" *\d{4}-\d\d-\d\d")
_ROWS_AT_ONCE = 65536


def read_runs(path: str, data: Mapping[str, Any], needed: Needed) -> list[Run]:
    """Read all runs of a file."""
    suffix = Path(path).suffix.lower()
    try:
        if suffix in TABLES:
            return _runs_of_table(path, suffix, data, needed)
        if suffix in NETCDF:
            return _runs_of_netcdf(path, data, needed)
        if suffix in NUMPY:
            return _runs_of_numpy(path, data, needed)
    except _FoundError:
        raise
    except UnicodeError as error:
        raise ValueError(f"{path} is not written in UTF-8: save it so ({error})") from error
    except Exception as error:  # whatever the libraries of the formats raise
        told = str(error)
        if not told.startswith(path):
            told = f"{path} cannot be read: {told}"
        raise ValueError(told) from error
    known = ", ".join((*TABLES, *NETCDF, *NUMPY))
    raise ValueError(f"{path}: files of series end in {known}")


class _FoundError(Exception):
    """Stops the reading of a file when the names of its columns are known."""


def column_names(path: str, data: Mapping[str, Any]) -> list[str]:
    """Names of the columns of a file, as its header or its arrays have them: no value is read.

    ``path``, ``data``: As in `read_runs`. The column that tells series apart is none of them.
    """
    found: list[str] = []

    def told(known: Sequence[str]) -> Sequence[str]:
        found.extend(known)
        raise _FoundError

    try:
        read_runs(path, data, told)
    except _FoundError:
        return found
    raise ValueError(f"{path} has no columns")


def axis_of(name: str) -> str:
    """The axis of `AXES` that a name means: of "realisation", "series"; unknown names stay."""
    return _SYNONYMS.get(name.lower(), name.lower() if name.lower() in AXES else name)


def _asked(path: str, known: Iterable[object], needed: Needed) -> list[str]:
    try:
        return list(needed([str(name) for name in known]))
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def _named(path: str, count: int, columns: Sequence[str]) -> list[str]:
    """Names of columns that have none in their file."""
    if columns and len(columns) != count:
        raise ValueError(f"{path} has {count} columns, but data.columns names {len(columns)}")
    return list(columns) or [f"column_{number}" for number in range(1, count + 1)]


# -- tables ----------------------------------------------------------------------------------------


class _Row(NamedTuple):
    """A row of a text table: its line, its fields, and the line that parts it from the last row."""

    line: int
    fields: list[str]
    parted_by: int | None


class _Layout(NamedTuple):
    """First row, number of columns to the last named one, and what the first sample has there."""

    head: _Row
    has_header: bool
    width: int
    end: str


class _Columns(NamedTuple):
    """Columns of a table, with the label of each row where a column has labels."""

    values: dict[str, Array]
    labels: list[str]
    lines: list[int]


def _runs_of_table(path: str, suffix: str, data: Mapping[str, Any], needed: Needed) -> list[Run]:
    key = data["series"]

    def chosen(names: Sequence[str]) -> list[str]:
        for name in names:
            if name and names.count(name) > 1:
                raise ValueError(f"{path} has {names.count(name)} columns that are called {name!r}")
        if key is not None and key not in names:
            raise ValueError(f"{path} has no column {key!r}{suggestion(key, names)} (data.series)")
        return _asked(path, [name for name in names if name != key], needed)

    read = _parquet if suffix == ".parquet" else _text
    values, labels, lines = read(path, data, chosen)
    if key is None:
        return [Run(path, values)]
    return [
        Run(f"{path}, {key} {label}", {name: column[rows] for name, column in values.items()})
        for label, rows in _rows_by_label(path, data, labels, lines).items()
    ]


def _rows_by_label(
    path: str, data: Mapping[str, Any], labels: list[str], lines: list[int]
) -> dict[str, npt.NDArray[np.int64]]:
    """Rows of each run of a table, in the order of the file."""
    key, numbers = data["series"], dict[str, int]()
    run = np.array([numbers.setdefault(label, len(numbers)) for label in labels])
    spellings: dict[object, str] = {}
    for label, number in numbers.items():
        value = _number(label)
        if value is not None and np.isnan(value):
            line = lines[int((run == number).argmax())]
            raise ValueError(f"{path}, line {line} has no label in column {key!r} (data.series)")
        if (other := spellings.setdefault(label if value is None else value, label)) != label:
            raise ValueError(
                f"{path}: the column {key!r} has the labels {other!r} and {label!r}, which are the "
                f"same number: write them alike"
            )
    again = np.diff(run) < 0
    # the check of times finds out whether the rows of a label follow one another
    if again.any() and data["time"] is None:
        row = int(again.argmax()) + 1
        raise ValueError(
            f"{path}, line {lines[row]}: the label {labels[row]!r} of {key!r} comes again after "
            f"{labels[row - 1]!r}: give each run a label of its own, or name the column of times "
            f"that orders its rows (data.time)"
        )
    return {label: np.flatnonzero(run == number) for label, number in numbers.items()}


def _parquet(
    path: str, data: Mapping[str, Any], chosen: Callable[[Sequence[str]], list[str]]
) -> _Columns:
    try:
        table = pd.read_parquet(path)
    except ImportError:
        raise ValueError(
            f"{path}: reading Parquet takes pyarrow, which is not installed: install it, or "
            f"convert the file to CSV or NetCDF"
        ) from None
    table.columns = pd.Index([str(name) for name in table.columns])
    values = {}
    read = _time_stamps(data)
    for name in chosen(list(table.columns)):
        if read is not None and name == data["time"]:
            texts = ["" if stamp is pd.NaT else str(stamp) for stamp in table[name]]
            places = [f"{path}, row {row}" for row in range(1, len(texts) + 1)]
            values[name] = np.array(_times(read, texts, places, name))
            continue
        if table[name].dtype.kind not in "iuf":
            raise ValueError(f"{path}: column {name!r} has no numbers, but {table[name].dtype}")
        values[name] = table[name].to_numpy(dtype=np.float64, na_value=np.nan)
    if not len(table):
        raise ValueError(f"{path} has no rows")
    key = data["series"]
    labels = [] if key is None else [str(label) for label in table[key]]
    return _Columns(values, labels, list(range(1, len(table) + 1)))


def _text(
    path: str, data: Mapping[str, Any], chosen: Callable[[Sequence[str]], list[str]]
) -> _Columns:
    with open(path, encoding="utf-8-sig") as file:
        rows = _rows(path, file)
        head = list(itertools.islice(rows, 2))
        if not head:
            raise ValueError(f"{path} is empty")
        names, first = _header(path, head, data)
        width = max((place for place, name in enumerate(names, 1) if name), default=len(names))
        sample = head[first].fields if len(head) > first else []
        layout = _Layout(head[0], first == 1, width, _kind("".join(sample[width - 1 : width])))
        for row in head[1:]:  # a blank in a name makes two names
            _check_row(path, row, layout, is_first=True)
        parts: dict[str, list[Array]] = {name: [] for name in chosen(names)}
        labels: list[str] = []
        lines: list[int] = []
        times = _time_stamps(data)
        body = itertools.chain(head[first:], rows)
        while chunk := list(itertools.islice(body, _ROWS_AT_ONCE)):
            for row in chunk:
                _check_row(path, row, layout, is_first=not lines)
                lines.append(row.line)
            for name, values in parts.items():
                read = times if name == data["time"] else None
                values.append(np.array(_numbers(path, name, chunk, names.index(name), read)))
            if data["series"] is not None:
                place = names.index(data["series"])
                labels += [row.fields[place].strip() for row in chunk]
    if not lines:
        raise ValueError(f"{path} has a header, but no rows")
    columns = {name: np.concatenate(found) for name, found in parts.items()}
    return _Columns(columns, labels, lines)


def _rows(path: str, lines: Iterable[str]) -> Iterator[_Row]:
    """Rows of a text table, without blank lines and comments."""
    separator = {".csv": ",", ".tsv": "\t"}.get(Path(path).suffix.lower())
    parted_by = None
    for number, line in enumerate(lines, 1):
        content = line.strip(" \n") if separator else line.strip()
        if not content or (content.startswith("#") and not _ERROR_OF_EXCEL.match(content)):
            parted_by = number
            continue
        try:
            fields = _fields(line.rstrip("\n"), separator)
        except (csv.Error, ValueError) as error:
            raise ValueError(f"{path}, line {number}: {error}") from None
        yield _Row(number, fields, parted_by)
        parted_by = None


def _fields(line: str, separator: str | None) -> list[str]:
    if separator is None:
        if "\t" in line and not all(map(str.strip, line.rstrip().split("\t"))):
            raise ValueError("a field between tabs is empty: such a file ends in .tsv")
        fields = list(filter(None, line.replace("\t", " ").split(" ")))  # no others part fields
        if '"' not in line:
            return fields
        line, separator = " ".join(fields), " "
    elif '"' not in line:
        return line.split(separator)
    # by lines: a quote that is not closed would take in the rows after it
    return next(csv.reader([line], delimiter=separator, strict=True, skipinitialspace=True))


def _header(path: str, head: Sequence[_Row], data: Mapping[str, Any]) -> tuple[list[str], int]:
    """Names of the columns, and how many rows they take."""
    line, first, _ = head[0]
    columns, said = data["columns"], data["header"]
    has_names = any(_number(text) is None for text in first) if said is None else said
    if said is None and not has_names and _may_be_names(*(row.fields for row in head)):
        raise ValueError(
            f"{path}, line {line}: {', '.join(first)} are the names of columns or the first "
            f"sample: say which (data.header: true or false)"
        )
    if not has_names:
        return _named(path, len(first), columns), 0
    names = [name.strip() for name in first]
    if said and columns:
        return _named(path, len(first), columns), 1
    if columns and names != list(columns):
        raise ValueError(
            f"{path} has a header in line {line}, {', '.join(names)}: leave out data.columns, "
            f"which says {', '.join(columns)}, or say what the line is (data.header: true or false)"
        )
    return names, 1


def _may_be_names(first: Sequence[str], second: Sequence[str] = ()) -> bool:
    """Whether a row of numbers looks like names: 0, 1, 2; 2001, 2002; 0.0, 0.25, 0.5; a gap."""
    values = [_number(text) or 0.0 for text in first]
    if any(map(math.isnan, values)):
        return True
    if len(set(values)) < len(values):
        return False
    step = values[1] - values[0] if len(values) > 1 else 1.0
    in_steps = all(
        abs(right - left - step) <= 1e-9 * abs(step) for left, right in itertools.pairwise(values)
    )
    if len(values) > 2 and in_steps:
        return True
    if not all(text.strip().isdecimal() for text in first):
        return False
    whole = all(text.strip().lstrip("-").isdecimal() for text in second)
    return not (second and whole) or (in_steps and step == 1 and values[0] in (0, 1))


def _check_row(path: str, row: _Row, layout: _Layout, *, is_first: bool) -> None:
    head, width = layout.head, layout.width
    if len(row.fields) != len(head.fields):
        raise ValueError(
            f"{path}, line {row.line} has {len(row.fields)} fields, but line {head.line} has "
            f"{len(head.fields)}"
        )
    if layout.has_header and row.fields == head.fields:
        raise ValueError(
            f"{path}, line {row.line} has the header of line {head.line} again: put each run into "
            f"a file of its own"
        )
    if row is not head and width < len(row.fields) and "".join(row.fields[width:]).strip():
        raise ValueError(
            f"{path}, line {row.line} has {row.fields[width:]} beyond the last column that has a "
            f"name, {head.fields[width - 1]!r} in line {head.line}: if its fields have moved, move "
            f"them back; or name all columns (data.header: true, and data.columns)"
        )
    if {layout.end, _kind(row.fields[width - 1])} == {"number", "empty"} and row is not head:
        raise ValueError(
            f"{path}, line {row.line}: the last field is {_kind(row.fields[width - 1])}, that of "
            f"the first sample {layout.end}: if the fields of a row have moved, move them back; "
            f"write nan for a gap"
        )
    if row.parted_by is not None and not is_first:
        raise ValueError(
            f"{path}, line {row.parted_by} is blank or a comment between rows: if a new run begins "
            f"there, put it into a file of its own or add a column that tells runs apart "
            f"(data.series); remove the line"
        )


def _time_stamps(data: Mapping[str, Any]) -> TimeStamps | None:
    """Reader of dates, where the unit of time is stated."""
    return TimeStamps(data["time_unit"], data["time_zone"]) if data["time_unit"] else None


def _numbers(
    path: str, name: str, rows: Sequence[_Row], place: int, read_time: TimeStamps | None
) -> list[float]:
    texts = [row.fields[place] for row in rows]
    if read_time is not None:
        return _times(read_time, texts, [f"{path}, line {row.line}" for row in rows], name)
    together = "".join(texts)
    if together.isascii() and "_" not in together:
        try:
            return list(map(float, texts))
        except ValueError:  # a gap, or text
            pass
    values = []
    for row, text in zip(rows, texts, strict=True):
        value = _number(text)
        if value is None:
            raise ValueError(
                f"{path}, line {row.line}: column {name!r} has {text!r}, which is no number (dates "
                f"are read as times, in a unit that is stated: data.time and data.time_unit)"
                if _DATE.match(text)
                else f"{path}, line {row.line}: column {name!r} has {text!r}, which is no number"
            )
        values.append(value)
    return values


def _times(read: TimeStamps, texts: Sequence[str], places: Sequence[str], name: str) -> list[float]:
    values = []
    for text, place in zip(texts, places, strict=True):
        try:
            values.append(read(text))
        except ValueError as error:
            raise ValueError(f"{place}: column {name!r} {error}") from None
    return values


def _kind(text: str) -> str:
    """Kind of a field: "number", "text", or "empty"."""
    if not text.strip():
        return "empty"
    return "text" if _number(text) is None else "number"


def _number(text: str) -> float | None:
    """Value of a field: NaN for a gap, None for text."""
    text = text.strip()
    if text.casefold() in _GAPS:
        return math.nan
    try:
        # Python's 1_000 is no number in a file
        return float(text) if text.isascii() and "_" not in text else None
    except ValueError:
        return None


# -- arrays ----------------------------------------------------------------------------------------

Read = Callable[[str], tuple[Array, Sequence[str]]]
"""Array of a name, and the names of its dimensions where they have any."""


def _runs_of_netcdf(path: str, data: Mapping[str, Any], needed: Needed) -> list[Run]:
    with open(path, "rb") as content:
        is_classic = content.read(3) == b"CDF"
    if is_classic:
        _check_complete(path)  # first: the library may crash when it opens a damaged one
    with netCDF4.Dataset(path, "r") as file:

        def read(name: str) -> tuple[Array, Sequence[str]]:
            variable = file[name]
            if variable.dtype is str:  # the library crashes when it reads numbers of 16 bits
                raise ValueError(
                    f"{path}, {name} is text, or has numbers of a type that NetCDF has not, such "
                    f"as float16: write it as float64"
                )
            values = variable[...]
            numbers = float_array(np.ma.getdata(values), f"{path}, {name}")
            # what is declared as missing is a gap
            return np.where(np.ma.getmaskarray(values), np.nan, numbers), variable.dimensions

        return _runs_of_arrays(path, _variables(file, ""), read, data, needed)


def _check_complete(path: str) -> None:
    """Check that a classic NetCDF file has all its bytes: netCDF4 reads zeros for missing ones."""
    try:
        with netcdf_file(path):
            pass
    except Exception as error:  # its parser has no errors of its own
        raise ValueError(
            f"{path} is cut off, or is no classic NetCDF file of 32 or 64-bit offsets: copy it "
            f"again, or convert it (nccopy -k netCDF-4)"
        ) from error


def _variables(group: netCDF4.Dataset, prefix: str) -> list[str]:
    """Names of the variables of a file and of all groups in it."""
    below = (
        name
        for key, inside in group.groups.items()
        for name in _variables(inside, f"{prefix}{key}/")
    )
    return [*(f"{prefix}{name}" for name in group.variables), *below]


def _runs_of_numpy(path: str, data: Mapping[str, Any], needed: Needed) -> list[Run]:
    with open(path, "rb") as file:
        arrays = np.load(file, allow_pickle=False)
        if isinstance(arrays, np.ndarray):
            if file.read(1):
                raise ValueError("it has more after its first array: a .npy file holds one")
            arrays, data = {"array": arrays}, {**data, "array": "array"}

        def read(name: str) -> tuple[Array, Sequence[str]]:
            return float_array(arrays[name], f"{path}, {name}"), ()

        return _runs_of_arrays(path, list(arrays), read, data, needed)


def _runs_of_arrays(
    path: str, known: Sequence[str], read: Read, data: Mapping[str, Any], needed: Needed
) -> list[Run]:
    """Runs of a file with an array for each column, or one array for all columns."""
    columns: dict[str, Array] = {}
    shared = set()
    whole = data["array"]
    if whole is not None:
        if whole not in known:
            raise ValueError(
                f"{path} has no array {whole!r}{suggestion(whole, known)} (data.array); it has "
                f"{', '.join(known)}"
            )
        array, dimensions = read(whole)
        block = _ordered(f"{path}, {whole}", array, dimensions, data, "component")
        names = _named(f"{path}, {whole}", block.shape[2], data["columns"])
        columns = {name: block[:, :, index] for index, name in enumerate(names)}
        shared = {name for name in names if array.ndim == 2}
    others = [name for name in known if name != whole and name not in columns]
    for name in _asked(path, [*columns, *others], needed):
        if name not in columns:
            array, dimensions = read(name)
            columns[name] = _ordered(f"{path}, {name}", array, dimensions, data)[:, :, 0]
            if array.ndim == 1:
                shared.add(name)
    count = max(len(values) for values in columns.values())
    for name, values in columns.items():
        # what has no axis of series, such as times, serves all of them
        first, others_first = next(iter(columns.items()))
        fits = len(values) == count or name in shared
        if not fits or values.shape[1] != others_first.shape[1]:
            raise ValueError(
                f"{path}: {name} and {first} have the shapes {values.shape} and "
                f"{others_first.shape} (series, time), which do not fit"
            )
    return [
        Run(
            path if count == 1 else f"{path}, series {row + 1}",
            {name: values[min(row, len(values) - 1)] for name, values in columns.items()},
        )
        for row in range(count)
    ]


def _ordered(
    where: str, array: Array, dimensions: Sequence[str], data: Mapping[str, Any], *last: str
) -> Array:
    """Array as ``(series, time, component)``: by its axes as they are said, named, or evident."""
    names = [name if name in AXES else None for name in map(axis_of, dimensions)]
    order: list[str] = []
    if data["axes"]:
        order = [axis for axis in data["axes"] if axis != "component" or last]
        # an array of times has no series
        order = [axis for axis in order if axis != "series"] if array.ndim == 1 else order
    elif names and None not in names:
        order = [name for name in names if name is not None]
    elif not any(names):
        lengths = [length == len(data["columns"]) for length in array.shape]
        if array.ndim == 1 and not last:
            order = ["time"]
        elif lengths == [False, True] and last:
            order = ["time", *last]
    shape = f"{where} has {array.ndim} axes of lengths {array.shape}"
    if dimensions:
        shape += f", named {', '.join(dimensions)}"
    if not order:
        raise ValueError(
            f"{shape}, and nothing says which is which: name them in their order, such as "
            f"data.axes: [{', '.join(AXES)}]"
        )
    if len(order) != array.ndim or len(set(order)) < array.ndim or not {"time", *last} <= {*order}:
        raise ValueError(f"{shape}; it takes {' and '.join(order)} (data.axes)")
    if any(name not in (None, axis) for name, axis in zip(names, order, strict=False)):
        raise ValueError(f"{shape}, but data.axes calls them {', '.join(order)}")
    if "component" in order and not last:
        raise ValueError(f"{shape}: it holds several columns (data.array)")
    if not array.size:
        raise ValueError(f"{shape}: it is empty")
    missing = [axis for axis in AXES if axis not in order]
    full = array.reshape(*array.shape, *[1] * len(missing))
    return full.transpose([[*order, *missing].index(axis) for axis in AXES])
