"""Event forecasters in NetCDF files: nothing is pickled, imported or allocated on a file's word.

A file holds a digest of its content, which tells damage; whoever writes a file can make one, so
that all that is read is checked: arrays lie in the file in full, kinds and systems are those of
this package, and what a forecaster allocates is no larger than what it has learnt.
"""

import hashlib
import json
import math
import numbers
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from burstcast.event_forecaster.observed_states import Observable
from burstcast.forecasters.base import ForecasterKind, ForecasterRecord, ForecastingCase
from burstcast.forecasters.registry import kind_name
from burstcast.forecasts.alarms import AlarmRule
from burstcast.systems.base import DynamicalSystem
from burstcast.systems.registry import make_system, parameters_of

_FORMAT = 2
_TUPLES = ("prediction_times", "spectral_radius", "input_scaling", "tikhonov")
_CONNECTIONS = 1000
"""Most connections of a reservoir, for each number that is in the file."""
_MOST = 1_000_000
"""Largest of a file's own numbers that time or memory grow with."""
_WRONG = (
    *(ArithmeticError, AttributeError, LookupError, MemoryError, NotImplementedError),
    *(RecursionError, TypeError, ValueError),
)


def write_saved(
    path: str | Path,
    parameters: Mapping[str, Any],
    fitted: Mapping[str, Any],
    members: Sequence[ForecasterRecord],
) -> None:
    """Write an event forecaster, without an observable of the user's; replaces a file.

    ``parameters``: Of its constructor. ``fitted``: What fitting has found. ``members``: Records of
    its forecasters.
    """
    # the NetCDF library takes a moment to load, which other forecasters need not wait for
    from burstcast.base.files.netcdf import Variable, write_netcdf

    variables: dict[str, Variable] = {}
    for number, member in enumerate(members):
        for name, array in member.arrays.items():
            label = f"member{number}_{name}"
            axes = tuple(f"{label}_{axis}" for axis in range(array.ndim))
            meaning = f"{name.replace('_', ' ')} of member {number}"
            variables[label] = Variable(axes, array, None, meaning)
    observable = _observable_record(parameters["observable"])
    attributes: dict[str, str | int] = {"event_forecaster": _FORMAT}
    for name, content in (
        ("parameters", {**parameters, "observable": observable}),
        ("fitted", {**fitted, "members": [dict(member.attributes) for member in members]}),
    ):
        attributes[name] = json.dumps(content, sort_keys=True, default=_plain)
    arrays = {name: np.asarray(variable.data) for name, variable in variables.items()}
    attributes["digest"] = _digest(attributes, arrays)
    write_netcdf(path, variables, attributes)


def read_saved(
    path: str | Path, observable: Observable | None, kind: type[ForecasterKind] | None
) -> tuple[dict[str, Any], dict[str, Any], list[ForecasterRecord]]:
    """Parameters, fitted values and members of an event forecaster (`write_saved`).

    ``observable``, ``kind``: A function and a class of the user's, which are not in the file.
    """
    from burstcast.base.files.netcdf import read_attributes, read_netcdf

    try:
        _check_stored(path)
        attributes, arrays = read_attributes(path), read_netcdf(path)
    except (FileNotFoundError, PermissionError):
        raise
    except (OSError, RuntimeError) as error:  # of the NetCDF library
        raise ValueError(f"{path} is damaged ({error}): save the forecaster again") from error
    of_this_format = attributes.get("event_forecaster") == _FORMAT
    if not (of_this_format and {"parameters", "fitted"} <= attributes.keys()):
        raise ValueError(f"{path} holds no event forecaster that this version can read")
    if attributes.pop("digest", None) != _digest(attributes, arrays):
        raise ValueError(f"{path} is not what was saved: it is damaged; save the forecaster again")
    parameters, fitted = (json.loads(str(attributes[name])) for name in ("parameters", "fitted"))
    for name in _TUPLES:
        if isinstance(parameters[name], list):  # or a single number
            parameters[name] = tuple(parameters[name])
    components = len(fitted["reference_states"][0])
    if fitted["components"] != components:
        raise ValueError(
            f"{path} has other reference states than {fitted['components']} components"
        )
    record = parameters["observable"]
    parameters["observable"] = _observable_of(record, components, observable, path)
    parameters["kind"] = _kind_of(parameters["kind"], kind, path)
    arrays_of_members: list[dict[str, Any]] = [{} for _ in fitted["members"]]
    for name, array in arrays.items():
        number, _, label = name.removeprefix("member").partition("_")
        arrays_of_members[int(number)][label] = array
    return parameters, fitted, list(map(ForecasterRecord, arrays_of_members, fitted["members"]))


@contextmanager
def as_one_error(path: str | Path) -> Iterator[None]:
    """Whatever is wrong with a file as one `ValueError` that names it."""
    try:
        yield
    except _WRONG as error:
        if isinstance(error, ValueError) and str(path) in str(error):
            raise
        reason = f"{type(error).__name__}: {error}"
        raise ValueError(f"{path} holds no event forecaster that can be read: {reason}") from error


def check_sizes(record: ForecasterRecord, case: ForecastingCase, kind: ForecasterKind) -> None:
    """Check that a forecaster restored from a record is no larger than its arrays.

    They have a number for each neuron, and for each monomial of a state, of several states or of
    parameters. What a class of one's own allocates is its own affair.
    """
    stored, attributes = sum(array.size for array in record.arrays.values()), record.attributes
    if not all(np.isfinite(array).all() for array in record.arrays.values()):
        raise ValueError("a stored number is not finite")
    if ":" in kind_name(type(kind)):
        return
    neurons, dimension = int(attributes.get("neurons", 0)), case.system.dimension
    if neurons:
        rows, scale = record.arrays["weights"].shape[0], record.arrays["input_range"]
        offset = record.arrays.get("input_offset", scale)
        few = float(attributes["connectivity"]) * neurons <= _CONNECTIONS * stored
        scaled = scale.shape == offset.shape == (dimension,)
        if rows % (neurons + 1) or not scaled or not few:
            raise ValueError(f"{stored} stored numbers are no network of {neurons} neurons")
    of_parameters = 0 if case.parameters is None else len(case.parameters.names)
    counted = [(int(kind.options.get("degree", 0)), dimension)] if record.arrays else []
    if "lags" in kind.options:
        counted.append((2, int(kind.options["lags"]) * dimension))
    counted.append((int(attributes.get("parameter_degree", 0)), of_parameters))
    for degree, of in counted:
        # the smaller number first: neither the binomial coefficient nor its computing is long
        if degree > stored or math.comb(of + degree, min(of, degree)) > stored + 1:
            raise ValueError(f"{stored} stored numbers are no polynomial of degree {degree}")


def check_complete(record: ForecasterRecord, restored: ForecasterRecord) -> None:
    """Check that a record has the arrays of the forecaster that was restored from it."""
    if lacking := sorted(restored.arrays.keys() - record.arrays.keys()):
        raise ValueError(f"it lacks the array {', '.join(lacking)}")


def check_effort(kind: ForecasterKind, steps: int, stride: int) -> None:
    """Check that a forecast of a loaded forecaster is none that never ends.

    ``steps``: Of a washout and the longest forecast. ``stride``: Integration steps in each of them.
    """
    numbers = {"steps of washout and forecast": steps, "sampling_stride": stride, **kind.options}
    for name, number in numbers.items():
        if isinstance(number, int) and abs(number) > _MOST:
            raise ValueError(f"{name} is {number}, which is more than {_MOST}")


def restored_rule(record: Mapping[str, Any]) -> AlarmRule:
    """Alarm rule from its record: rising knots, probabilities, and a number as the threshold."""
    rule = AlarmRule.restore(record)
    knots, chances = rule.calibration.values, rule.calibration.probabilities
    sound = knots.shape == chances.shape and bool((np.diff(knots) > 0).all())
    if not sound or not ((chances >= 0) & (chances <= 1)).all() or np.isnan(rule.threshold):
        raise ValueError("the rule of an alarm is none")
    return rule


def _check_stored(path: str | Path) -> None:
    """Check that all arrays that a file declares lie in it, one number after the other."""
    import netCDF4

    with netCDF4.Dataset(path, "r") as file:
        claimed = 0
        for name, variable in file.variables.items():
            size = math.prod(variable.shape)
            plain = isinstance(variable.dtype, np.dtype) and variable.dtype.kind in "biuf"
            if not plain or (size and variable.chunking() != "contiguous"):
                raise ValueError(f"{path} holds no event forecaster: {name} is no plain array")
            claimed += size * variable.dtype.itemsize
        if file.groups or claimed > Path(path).stat().st_size:
            raise ValueError(f"{path} is damaged: it declares more than it holds")


def _digest(attributes: Mapping[str, Any], arrays: Mapping[str, npt.NDArray[Any]]) -> str:
    """SHA-256 of the attributes and variables of a file."""
    content = hashlib.sha256(json.dumps(sorted(attributes.items())).encode())
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        content.update(f"{name} {array.dtype.str} {array.shape} ".encode())
        content.update(array.tobytes())
    return content.hexdigest()


def _plain(value: Any) -> Any:
    """A number, a sequence or a mapping of any type as JSON has it."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, numbers.Real):
        return float(value)
    if isinstance(value, Sequence):
        return list(value)
    if isinstance(value, Mapping):
        return dict(value)
    raise TypeError(f"{value!r} cannot be saved")


def _observable_record(observable: Observable) -> Any:
    if isinstance(observable, DynamicalSystem):
        package, _, name = type(observable).__module__.rpartition(".")
        if package == "burstcast.systems":
            return {"system": name, "parameters": parameters_of(observable)}
        return "given"
    if isinstance(observable, str):
        return {"label": observable}
    return "given" if callable(observable) else int(observable)


def _kind_of(
    name: str, given: type[ForecasterKind] | None, path: str | Path
) -> str | type[ForecasterKind]:
    """Kind of a file: of this package by its name, or the given class of one's own."""
    if ":" not in name:
        return name
    if given is None:
        raise ValueError(
            f"the forecaster of {path} is a class of one's own, {name}, which the file has not: "
            "give it as load(path, kind=...)"
        )
    if kind_name(given).rpartition(":")[2] != name.rpartition(":")[2]:
        raise ValueError(f"the forecaster of {path} is a {name}, not a {kind_name(given)}")
    return given


def _observable_of(
    record: Any, components: int, given: Observable | None, path: str | Path
) -> Observable:
    if given is not None:
        return given
    if record == "given":
        raise ValueError(
            f"the observable of {path} is a function or a system of one's own, which the file has "
            f"not: give it as load(path, observable=...)"
        )
    if not isinstance(record, Mapping):
        return int(record)
    if "label" in record:
        return str(record["label"])
    name = str(record["system"])
    if ":" in name:  # a module of one's own, which would run
        raise ValueError(f"{path} names the system {name}, which is not one of burstcast's")
    if (2 * record["parameters"].get("largest_wavenumber", 0) + 1) ** 2 > components + 1:
        raise ValueError(f"{path} has a system of more than {components} components")
    return make_system(name, record["parameters"])
