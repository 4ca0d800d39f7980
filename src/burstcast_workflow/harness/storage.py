"""Files of the workflow: NetCDF, JSON and text, written whole or not at all.

A file is written under a temporary name beside its final one, flushed to the disk and renamed, so
that a job that dies leaves nothing that looks finished. Nothing in a file depends on the time, the
machine or the path: equal content is equal bits. Tables are in `burstcast_workflow.harness.tables`,
figures in `burstcast_workflow.harness.figures`.
"""

import errno
import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import netCDF4
import numpy as np
import numpy.typing as npt

from burstcast.described import descriptions
from burstcast_workflow.harness.run import check_ownership

T = TypeVar("T")

PARTIAL_SUFFIX = ".partial"

_LITTLE_SPACE = 2**16


@contextmanager
def atomic(path: str | Path) -> Iterator[Path]:
    """Give a temporary path to write to, which becomes ``path`` if all goes well.

    On any exception the temporary file is removed and ``path`` is left as it was.

    Raises
    ------
    OvertakenError
        If a newer run of the workflow has the results now.
    OSError
        If the disk is full, among others: libraries that write files do not always say so.
    """
    path = Path(path)
    # unique: the job of a killed workflow may still be writing while the next one starts
    partial = path.with_name(f".{path.name}.{os.urandom(6).hex()}{PARTIAL_SUFFIX}")
    try:
        yield partial
        _flush_to_disk(partial)
        check_ownership()
        os.replace(partial, path)
    except BaseException as error:
        full = isinstance(error, OSError | RuntimeError) and _disk_is_full(path.parent, error)
        partial.unlink(missing_ok=True)
        if full:
            text = "the disk is full: make room, and run again"
            raise OSError(errno.ENOSPC, text, str(path)) from error
        raise
    _flush_to_disk(path.parent)


def remove_partial(path: str | Path) -> None:
    """Remove what writers of ``path`` that were killed have left behind.

    A writer that is still alive loses its temporary file and fails: the caller takes its place.
    """
    path = Path(path)
    prefix = f".{path.name}."
    if path.parent.is_dir():
        for entry in list(os.scandir(path.parent)):
            if entry.name.startswith(prefix) and entry.name.endswith(PARTIAL_SUFFIX):
                Path(entry.path).unlink(missing_ok=True)


def _disk_is_full(directory: Path, error: BaseException) -> bool:
    if getattr(error, "errno", None) in (errno.ENOSPC, errno.EDQUOT):
        return True
    state = os.statvfs(directory)
    return state.f_bavail * state.f_frsize < _LITTLE_SPACE


def _flush_to_disk(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


@dataclass(frozen=True)
class Variable:
    """A variable of a NetCDF file.

    Attributes
    ----------
    dimensions
        Names of the array's axes; variables that share a name must agree on the length.
    data
        Real numbers or truth values.
    units
        Units in UDUNITS spelling; "1" for a number without units.
    description
        What it is, in words (the attribute ``long_name``).
    chunks
        Lengths of the chunks that the file stores it in, one per dimension; None: in one piece.
        A partial read costs as many whole chunks as it touches.
    """

    dimensions: tuple[str, ...]
    data: npt.ArrayLike
    units: str
    description: str
    chunks: tuple[int, ...] | None = None


def variables_of(record: Any) -> dict[str, Variable]:
    """Variables of a dataclass whose fields are `burstcast.described` arrays, by their names."""
    return {
        name: Variable(tuple(what.axes.split()), getattr(record, name), "1", what.meaning)
        for name, what in descriptions(type(record)).items()
    }


def write_netcdf(
    path: str | Path,
    variables: Mapping[str, Variable],
    attributes: Mapping[str, str | int | float],
) -> None:
    """Write arrays with their names, dimensions, units and what made them to a NetCDF file.

    Truth values are stored as bytes with the attribute ``dtype = "bool"``, as xarray does.

    Parameters
    ----------
    path
        The file; its directory exists.
    variables
        By name; they appear in the file in this order.
    attributes
        Of the whole file: its provenance. They appear sorted by name.

    Raises
    ------
    ValueError
        If dimensions and data disagree.
    TypeError
        If a variable or an attribute has a type that the file cannot hold.
    """
    arrays = {name: np.asarray(variable.data) for name, variable in variables.items()}
    lengths = _dimension_lengths(variables, arrays)
    for name, value in attributes.items():
        if isinstance(value, bool) or not isinstance(value, str | int | float):
            raise TypeError(f"attribute {name}: {value!r} is neither text nor a number")
    with (
        atomic(path) as partial,
        netCDF4.Dataset(partial, "x", format="NETCDF4") as file,
    ):
        file.setncatts({name: attributes[name] for name in sorted(attributes)})
        for dimension, length in lengths.items():
            file.createDimension(dimension, length)  # length 0 makes it unlimited: reads the same
        for name, variable in variables.items():
            _write_variable(file, name, variable, arrays[name])


def _dimension_lengths(
    variables: Mapping[str, Variable], arrays: Mapping[str, npt.NDArray[Any]]
) -> dict[str, int]:
    lengths: dict[str, int] = {}
    for name, variable in variables.items():
        shape = arrays[name].shape
        if arrays[name].dtype.kind not in "biuf":
            raise TypeError(f"variable {name}: cannot store data of type {arrays[name].dtype}")
        if len(shape) != len(variable.dimensions):
            raise ValueError(
                f"variable {name}: {len(variable.dimensions)} dimensions {variable.dimensions} "
                f"for data of shape {shape}"
            )
        if variable.chunks is not None and len(variable.chunks) != len(shape):
            raise ValueError(f"variable {name}: chunks {variable.chunks} for data of shape {shape}")
        for dimension, length in zip(variable.dimensions, shape, strict=True):
            if lengths.setdefault(dimension, length) != length:
                raise ValueError(
                    f"variable {name}: dimension {dimension} has length {length}, "
                    f"and {lengths[dimension]} in another variable"
                )
    return lengths


def _write_variable(
    file: netCDF4.Dataset, name: str, variable: Variable, array: npt.NDArray[Any]
) -> None:
    truth = array.dtype.kind == "b"
    chunks = None
    if variable.chunks is not None and array.size > 0:
        chunks = [
            min(chunk, length) for chunk, length in zip(variable.chunks, array.shape, strict=True)
        ]
    created = file.createVariable(
        name,
        "i1" if truth else array.dtype,
        variable.dimensions,
        chunksizes=chunks,
        # data in one piece need no filling beforehand; the margins of chunks do, or they would
        # hold whatever was in memory
        fill_value=None if chunks else False,
    )
    created.set_auto_maskandscale(False)
    attributes = {"long_name": variable.description, "units": variable.units}
    if truth:
        attributes["dtype"] = "bool"
    created.setncatts(attributes)
    if array.size > 0:
        created[...] = array.astype("i1") if truth else array


def _read(variable: "netCDF4.Variable[Any]", index: Any) -> npt.NDArray[Any]:
    variable.set_auto_maskandscale(False)
    data = np.asarray(variable[index])
    if "dtype" in variable.ncattrs() and variable.getncattr("dtype") == "bool":
        return data.astype(bool)
    return data


def _variable(file: netCDF4.Dataset, path: str | Path, name: str) -> "netCDF4.Variable[Any]":
    if name not in file.variables:
        raise KeyError(f"{path} has no variable {name!r}; it has {', '.join(file.variables)}")
    return file.variables[name]


def read_netcdf(path: str | Path, *names: str) -> dict[str, npt.NDArray[Any]]:
    """Read the named variables of a NetCDF file, all of them when no name is given.

    Raises
    ------
    KeyError
        If the file has no variable of that name.
    """
    with netCDF4.Dataset(path, "r") as file:
        return {name: _read(_variable(file, path, name), ...) for name in (names or file.variables)}


def read_record(path: str | Path, kind: type[T]) -> T:
    """Read a dataclass of arrays whose `variables_of` are in a NetCDF file.

    Raises
    ------
    KeyError
        If one of them is not.
    """
    return kind(**read_netcdf(path, *descriptions(kind)))


def read_rows(path: str | Path, name: str, start: int, stop: int) -> npt.NDArray[Any]:
    """Read entries ``start`` to ``stop - 1`` of a variable along its first dimension.

    Raises
    ------
    KeyError
        If the file has no variable of that name.
    IndexError
        If the variable has no such rows.
    """
    with netCDF4.Dataset(path, "r") as file:
        variable = _variable(file, path, name)
        if not 0 <= start <= stop <= variable.shape[0]:
            raise IndexError(
                f"{path}: rows {start} to {stop} of {name}, which has {variable.shape[0]}"
            )
        return _read(variable, slice(start, stop))


def read_attributes(path: str | Path) -> dict[str, str | int | float]:
    """Read the attributes of a whole NetCDF file: what made it."""
    with netCDF4.Dataset(path, "r") as file:
        values = {name: file.getncattr(name) for name in file.ncattrs()}
    return {
        name: value.item() if isinstance(value, np.generic) else value
        for name, value in values.items()
    }


def write_text(path: str | Path, text: str) -> None:
    """Write text in UTF-8, with line ends as they are."""
    with atomic(path) as partial:
        partial.write_bytes(text.encode())


def write_json(path: str | Path, record: Any) -> None:
    """Write plain data as JSON with sorted keys; what is undefined must be given as None.

    Raises
    ------
    ValueError
        If a number is not finite.
    TypeError
        If a value has no counterpart in JSON (an array, a NumPy integer, a path, ...).
    """
    try:
        text = json.dumps(record, sort_keys=True, indent=2, ensure_ascii=False, allow_nan=False)
    except (TypeError, ValueError) as error:
        raise type(error)(f"{path}: {error}") from error
    write_text(path, text + "\n")


def read_json(path: str | Path) -> Any:
    """Read a JSON file.

    Raises
    ------
    ValueError
        If it is none; the message names the file.
    """
    try:
        return json.loads(Path(path).read_bytes())
    except ValueError as error:
        raise ValueError(f"{path} is no JSON: {error}") from error
