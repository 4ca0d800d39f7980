"""NetCDF files of named arrays, each with its dimensions, its unit and its meaning.

Nothing in a file depends on the time, the machine or the path: equal content is equal bits.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import numpy as np
import numpy.typing as npt

from burstcast.base.files.atomic_files import atomic
from burstcast.base.files.described import descriptions

if TYPE_CHECKING:
    import netCDF4

T = TypeVar("T")


@dataclass(frozen=True)
class Variable:
    """A variable of a NetCDF file."""

    #: names of the array's axes; variables that share a name must agree on the length
    dimensions: tuple[str, ...]
    data: npt.ArrayLike  #: real numbers or truth values
    #: one of `burstcast.base.files.units`; None where the entries have no unit in common
    units: str | None
    description: str  #: what it is, in words (the attribute ``long_name``)
    #: lengths of the chunks that the file stores it in, one per dimension; None: in one piece. A
    #: partial read costs as many whole chunks as it touches.
    chunks: tuple[int, ...] | None = None


def _opened(path: str | Path, mode: Literal["r", "x"] = "r") -> "netCDF4.Dataset":
    """An open file."""
    import netCDF4  # planning, and jobs from the cache, start without it

    return netCDF4.Dataset(path, mode, format="NETCDF4")


def variables_of(record: Any) -> dict[str, Variable]:
    """Variables of a dataclass, by name; its fields are `burstcast.base.files.described` arrays."""
    return {
        name: Variable(tuple(what.axes.split()), getattr(record, name), what.unit, what.meaning)
        for name, what in descriptions(type(record)).items()
    }


def coefficients(arrays: Mapping[str, npt.NDArray[Any]]) -> dict[str, Variable]:
    """Variables of arrays by name, each with axes of its own, which have no common unit."""
    return {
        name: Variable(
            tuple(f"{name}_{axis}" for axis in range(array.ndim)),
            array,
            None,
            name.replace("_", " "),
        )
        for name, array in arrays.items()
    }


def write_netcdf(
    path: str | Path,
    variables: Mapping[str, Variable],
    attributes: Mapping[str, str | int | float],
    check: Callable[[], None] | None = None,
) -> None:
    """Write arrays with their names, dimensions, units and meanings to a NetCDF file.

    Truth values are stored as bytes with the attribute ``dtype = "bool"``, as xarray does.
    ``attributes``: Of the whole file, sorted by name. ``check``: Called when the file is complete,
    before it replaces an older one; it may raise.
    """
    arrays = {name: np.asarray(variable.data) for name, variable in variables.items()}
    lengths = _dimension_lengths(variables, arrays)
    for name, value in attributes.items():
        if isinstance(value, bool) or not isinstance(value, str | int | float):
            raise TypeError(f"attribute {name}: {value!r} is neither text nor a number")
    with (
        atomic(path, check) as partial,
        _opened(partial, "x") as file,
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
    file: "netCDF4.Dataset", name: str, variable: Variable, array: npt.NDArray[Any]
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
    attributes = {"long_name": variable.description}
    if variable.units is not None:
        attributes["units"] = variable.units
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


def _variable(file: "netCDF4.Dataset", path: str | Path, name: str) -> "netCDF4.Variable[Any]":
    if name not in file.variables:
        raise KeyError(f"{path} has no variable {name!r}; it has {', '.join(file.variables)}")
    return file.variables[name]


def read_netcdf(path: str | Path, *names: str) -> dict[str, npt.NDArray[Any]]:
    """Read the named variables of a NetCDF file; all variables if no name is given."""
    with _opened(path) as file:
        return {name: _read(_variable(file, path, name), ...) for name in (names or file.variables)}


def variable_names(path: str | Path) -> tuple[str, ...]:
    """Names of the variables of a NetCDF file."""
    with _opened(path) as file:
        return tuple(file.variables)


def read_record(path: str | Path, kind: type[T]) -> T:
    """Read a dataclass of arrays whose `variables_of` are in a NetCDF file."""
    return kind(**read_netcdf(path, *descriptions(kind)))


def read_rows(path: str | Path, name: str, start: int, stop: int) -> npt.NDArray[Any]:
    """Read entries ``start`` to ``stop - 1`` of a variable along its first dimension."""
    with _opened(path) as file:
        variable = _variable(file, path, name)
        if not 0 <= start <= stop <= variable.shape[0]:
            raise IndexError(
                f"{path}: rows {start} to {stop} of {name}, which has {variable.shape[0]}"
            )
        return _read(variable, slice(start, stop))


def read_attributes(path: str | Path) -> dict[str, Any]:
    """Read the attributes of a whole NetCDF file: its provenance; arrays are lists."""
    with _opened(path) as file:
        values = {name: file.getncattr(name) for name in file.ncattrs()}
    return {
        name: value.tolist() if isinstance(value, np.generic | np.ndarray) else value
        for name, value in values.items()
    }
