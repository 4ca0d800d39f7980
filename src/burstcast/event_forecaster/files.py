"""Event forecasters in NetCDF files, nothing pickled.

A file holds a digest of its content, which is verified when the file is read.
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from burstcast.event_forecaster.observed_states import Observable
from burstcast.forecasters.base import ForecasterRecord
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.registry import make_system, parameters_of

_FORMAT = 2
_TUPLES = ("prediction_times", "spectral_radius", "input_scaling", "tikhonov")


@dataclass(frozen=True)
class SavedForecaster:
    """Contents of a file of an event forecaster."""

    parameters: Mapping[str, Any]  #: parameters of its constructor
    fitted: Mapping[str, Any]  #: what fitting has found, as JSON has it
    members: Sequence[ForecasterRecord]  #: records of its forecasters


def write_saved(path: str | Path, saved: SavedForecaster) -> None:
    """Write an event forecaster, but for an observable that is a function or a system of one's own.

    The file replaces one that is there.
    """
    # the NetCDF library takes a moment to load, which other forecasters need not wait for
    from burstcast.files.netcdf import Variable, write_netcdf

    variables: dict[str, Variable] = {}
    for number, member in enumerate(saved.members):
        for name, array in member.arrays.items():
            label = f"member{number}_{name}"
            axes = tuple(f"{label}_{axis}" for axis in range(array.ndim))
            meaning = f"{name.replace('_', ' ')} of member {number}"
            variables[label] = Variable(axes, array, None, meaning)
    parameters = {
        **saved.parameters,
        "observable": _observable_record(saved.parameters["observable"]),
    }
    fitted = {**saved.fitted, "members": [dict(member.attributes) for member in saved.members]}
    attributes: dict[str, str | int] = {
        "event_forecaster": _FORMAT,
        "parameters": json.dumps(parameters, sort_keys=True, default=_plain),
        "fitted": json.dumps(fitted, sort_keys=True, default=_plain),
    }
    arrays = {name: np.asarray(variable.data) for name, variable in variables.items()}
    attributes["digest"] = _digest(attributes, arrays)
    write_netcdf(path, variables, attributes)


def read_saved(path: str | Path, observable: Observable | None) -> SavedForecaster:
    """Read an event forecaster.

    ``observable``: Observable, if it is a function or your own system: the file does not have it.
    """
    from burstcast.files.netcdf import read_attributes, read_netcdf

    try:
        attributes, arrays = read_attributes(path), read_netcdf(path)
    except (FileNotFoundError, PermissionError):
        raise
    except (OSError, RuntimeError) as error:  # of the NetCDF library
        raise ValueError(f"{path} is damaged ({error}): save the forecaster again") from error
    known = attributes.get("event_forecaster") == _FORMAT
    if not (known and {"parameters", "fitted"} <= attributes.keys()):
        raise ValueError(f"{path} holds no event forecaster that this version can read")
    if attributes.pop("digest", None) != _digest(attributes, arrays):
        raise ValueError(f"{path} is not what was saved: it is damaged; save the forecaster again")
    parameters, fitted = (json.loads(str(attributes[name])) for name in ("parameters", "fitted"))
    parameters |= {name: tuple(parameters[name]) for name in _TUPLES}
    parameters["observable"] = _observable_of(parameters["observable"], observable, path)
    members = []
    for number, found in enumerate(fitted["members"]):
        prefix = f"member{number}_"
        own = {
            name.removeprefix(prefix): array
            for name, array in arrays.items()
            if name.startswith(prefix)
        }
        members.append(ForecasterRecord(own, found))
    return SavedForecaster(parameters, fitted, members)


def _digest(attributes: Mapping[str, Any], arrays: Mapping[str, npt.NDArray[Any]]) -> str:
    """SHA-256 of the attributes and variables of a file."""
    content = hashlib.sha256(json.dumps(sorted(attributes.items())).encode())
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        content.update(f"{name} {array.dtype.str} {array.shape} ".encode())
        content.update(array.tobytes())
    return content.hexdigest()


def _plain(value: Any) -> Any:
    """A number or an array of NumPy as JSON has it."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise TypeError(f"{value!r} cannot be saved")


def _observable_record(observable: Observable) -> Any:
    if isinstance(observable, DynamicalSystem):
        package, _, name = type(observable).__module__.rpartition(".")
        if package == "burstcast.systems":
            return {"system": name, "parameters": parameters_of(observable)}
        return "given"
    return "given" if callable(observable) else int(observable)


def _observable_of(record: Any, given: Observable | None, path: str | Path) -> Observable:
    if given is not None:
        return given
    if record == "given":
        raise ValueError(
            f"the observable of {path} is a function or a system of one's own, which the file has "
            f"not: give it as load(path, observable=...)"
        )
    if isinstance(record, Mapping):
        return make_system(record["system"], record["parameters"])
    return int(record)
