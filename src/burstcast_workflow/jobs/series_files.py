"""Files that measured series come in: CSV, Parquet, NetCDF, HDF5 and NumPy's.

All of them are read into runs of named columns (`burstcast.measured_data.Run`).
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import numpy.typing as npt
import pandas as pd

from burstcast.discovery import suggestion
from burstcast.measured_data import Run

Array = npt.NDArray[np.float64]
Needed = Callable[[Sequence[str]], Sequence[str]]
"""Says which columns of those that there are are needed; a ValueError if one is not there."""

TABLES = (".csv", ".tsv", ".txt", ".dat", ".parquet")
NETCDF = (".nc", ".nc4", ".cdf", ".h5", ".hdf5", ".hdf")
NUMPY = (".npy", ".npz")
AXES = ("series", "time", "component")


def read_runs(path: str, data: Mapping[str, Any], needed: Needed) -> list[Run]:
    """Read all runs of a file.

    Parameters
    ----------
    path
        The file.
    data
        The section ``data`` of its case.
    needed
        What is read of it.

    Raises
    ------
    ValueError
        If the file is of another kind, or has not what is needed; the message names it.
    """
    suffix = Path(path).suffix.lower()
    try:
        if suffix in TABLES:
            return _runs_of_table(path, _table(path, suffix, data["columns"]), data, needed)
        if suffix in NETCDF:
            return _runs_of_netcdf(path, data, needed)
        if suffix in NUMPY:
            return _runs_of_numpy(path, data, needed)
    except OSError as error:
        raise ValueError(f"{path} cannot be read: {error}") from error
    known = ", ".join((*TABLES, *NETCDF, *NUMPY))
    raise ValueError(f"{path}: files of series end in {known}")


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


def _table(path: str, suffix: str, columns: Sequence[str]) -> pd.DataFrame:
    if suffix == ".parquet":
        try:
            found: pd.DataFrame = pd.read_parquet(path)
        except ImportError:
            raise ValueError(
                f"{path}: reading Parquet takes pyarrow, which is not installed: install it, or "
                f"convert the file to CSV or NetCDF"
            ) from None
        return found
    separator = {".csv": ",", ".tsv": "\t"}.get(suffix, r"\s+")
    how: dict[str, Any] = {"sep": separator, "comment": "#"}
    if int(pd.__version__.partition(".")[0]) < 3:  # later ones read all digits by themselves
        how["float_precision"] = "round_trip"
    try:
        head = pd.read_csv(path, header=None, nrows=1, dtype=str, **how)
        numbers_only = bool(pd.to_numeric(head.iloc[0], errors="coerce").notna().all())
        table: pd.DataFrame = pd.read_csv(path, header=None if numbers_only else 0, **how)
    except (pd.errors.ParserError, pd.errors.EmptyDataError, UnicodeDecodeError) as error:
        raise ValueError(f"{path} is no table of numbers: {error}") from None
    if numbers_only:
        table.columns = pd.Index(_named(path, table.shape[1], columns))
        return table
    table.columns = pd.Index([str(name).strip() for name in table.columns])
    if columns and list(table.columns) != list(columns):
        raise ValueError(
            f"{path} has a header, {', '.join(table.columns)}: leave out data.columns, which says "
            f"{', '.join(columns)}"
        )
    return table


def _runs_of_table(
    path: str, table: pd.DataFrame, data: Mapping[str, Any], needed: Needed
) -> list[Run]:
    key = data["series"]
    names = _asked(path, [name for name in table.columns if name != key], needed)
    columns = {name: _numbers(path, name, table[name]) for name in names}
    if key is None:
        return [Run(path, columns)]
    if key not in table.columns:
        known = list(map(str, table.columns))
        raise ValueError(f"{path} has no column {key!r}{suggestion(key, known)} (data.series)")
    labels = table[key].to_numpy()
    # in the order of the file, however their names would be sorted
    return [
        Run(
            f"{path}, {key} {label}",
            {name: values[labels == label] for name, values in columns.items()},
        )
        for label in dict.fromkeys(labels.tolist())
    ]


def _numbers(path: str, name: str, values: "pd.Series[Any]") -> Array:
    numbers = pd.to_numeric(values, errors="coerce")
    text = (numbers.isna() & values.notna()).to_numpy()
    if text.any():
        row = int(text.argmax())
        raise ValueError(
            f"{path}: column {name!r} has {values.iloc[row]!r} in row {row + 1}, which is no number"
        )
    return numbers.to_numpy(dtype=np.float64, na_value=np.nan)


# -- arrays ----------------------------------------------------------------------------------------


def _runs_of_netcdf(path: str, data: Mapping[str, Any], needed: Needed) -> list[Run]:
    with netCDF4.Dataset(path, "r") as file:

        def read(name: str) -> tuple[Array, tuple[str, ...]]:
            variable = file[name]
            # what is declared as missing is a gap
            values = np.ma.asarray(variable[...]).astype(np.float64)
            return np.ma.filled(values, np.nan), tuple(variable.dimensions)

        return _runs_of_arrays(path, _variables(file, ""), read, data, needed)


def _variables(group: netCDF4.Dataset, prefix: str) -> list[str]:
    """Names of the variables of a file and of all groups in it."""
    below = (
        name
        for key, inside in group.groups.items()
        for name in _variables(inside, f"{prefix}{key}/")
    )
    return [*(f"{prefix}{name}" for name in group.variables), *below]


def _runs_of_numpy(path: str, data: Mapping[str, Any], needed: Needed) -> list[Run]:
    loaded = np.load(path, allow_pickle=False)
    if isinstance(loaded, np.ndarray):
        arrays = {"array": loaded}
        data = {**data, "array": "array"}
    else:
        with loaded:
            arrays = {name: loaded[name] for name in loaded.files}

    def read(name: str) -> tuple[Array, tuple[str, ...]]:
        return arrays[name].astype(np.float64), ()

    return _runs_of_arrays(path, list(arrays), read, data, needed)


def _runs_of_arrays(
    path: str,
    known: Sequence[str],
    read: Callable[[str], tuple[Array, tuple[str, ...]]],
    data: Mapping[str, Any],
    needed: Needed,
) -> list[Run]:
    """Runs of a file with an array for each column, or one array that holds all of them."""
    columns: dict[str, Array] = {}
    whole = data["array"]
    if whole is not None:
        if whole not in known:
            raise ValueError(
                f"{path} has no array {whole!r}{suggestion(whole, known)} (data.array); it has "
                f"{', '.join(known)}"
            )
        block = _ordered(f"{path}, {whole}", *read(whole), data["axes"], "component")
        names = _named(f"{path}, {whole}", block.shape[2], data["columns"])
        columns = {name: block[:, :, index] for index, name in enumerate(names)}
    others = [name for name in known if name != whole and name not in columns]
    for name in _asked(path, [*columns, *others], needed):
        if name not in columns:
            columns[name] = _ordered(f"{path}, {name}", *read(name), data["axes"])[:, :, 0]
    count = max(len(values) for values in columns.values())
    for name, values in columns.items():
        # one time axis may serve all series
        first, others_first = next(iter(columns.items()))
        if len(values) not in (1, count) or values.shape[1] != others_first.shape[1]:
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
    where: str, array: Array, dimensions: Sequence[str], axes: Sequence[str], *last: str
) -> Array:
    """Array as ``(series, time, component)``: by its axes as they are said, or named, or usual."""
    usual = (*(("series",) if array.ndim - len(last) > 1 else ()), "time", *last)
    if axes:
        order = [axis for axis in axes if axis != "component" or last]
        # an array of times has no series
        order = [axis for axis in order if axis != "series"] if array.ndim == 1 else order
    else:
        order = list(dimensions if set(dimensions) <= set(AXES) and dimensions else usual)
    if len(order) != array.ndim or not set(last) <= set(order):
        raise ValueError(
            f"{where} has {array.ndim} axes of lengths {array.shape}; it takes "
            f"{' and '.join(order)} (data.axes)"
        )
    missing = [axis for axis in AXES if axis not in order]
    full = array.reshape(*array.shape, *[1] * len(missing))
    return full.transpose([[*order, *missing].index(axis) for axis in AXES])
