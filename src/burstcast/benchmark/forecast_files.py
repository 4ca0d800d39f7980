"""Forecasts of others as files, NetCDF or CSV: read strictly, or not at all.

The page of a task (``page.md``) says what such a file is. Whatever is wrong with one is one message
that names the file, the row, and what was expected.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import netCDF4
import numpy as np
import pandas as pd

from burstcast.arrays import FloatArray, IntArray
from burstcast.benchmark.task import ForecastTask
from burstcast.discovery import suggestion
from burstcast.forecast.windows import WindowSummaries, summarise
from burstcast.systems.state_space import component_names

MEMBER = "member"
_CSV, _NETCDF = (".csv",), (".nc", ".nc4")
_FACTS = ("case", "case_version", "seed")
_FIRST_LINE = re.compile(r"#\s*case=(\S+)\s+case_version=(\S+)\s+seed=(\S+)\s*")
_LINES_BEFORE = 2


class ForecastFileError(ValueError):
    """A file of forecasts that is not what a case asks for."""


class Facts(NamedTuple):
    """Case that forecasts belong to; its version is a digest of its data."""

    case: str
    case_version: str
    seed: int


@dataclass(frozen=True)
class Forecasts:
    """Forecasts of one forecaster for one case."""

    #: window summaries of the forecasts of each member; none where probabilities were given
    members: tuple[WindowSummaries, ...]
    #: probability of an event in each window, ``(points, prediction times)``; None where
    #: trajectories were given
    probability: FloatArray | None
    #: forecast observable from each point of the prediction horizon, ``(points, steps)``; None: it
    #: is not scored
    horizon: FloatArray | None


class _Form(NamedTuple):
    """A form that forecasts may have."""

    name: str  #: name of the variable in NetCDF
    axes: dict[str, FloatArray]  #: its dimensions but members, with values that count the entries
    columns: tuple[str, ...]  #: names of the values in CSV

    @property
    def subject(self) -> str:
        """What is forecast."""
        return "prediction horizon" if self.name.startswith("horizon") else "windows"

    @property
    def components(self) -> bool:
        """Whether the last dimension in NetCDF counts the components."""
        return self.name.endswith("state")

    @property
    def members(self) -> bool:
        """Whether there may be several members."""
        return self.name in ("observable", "state")

    def place(self, member: int | None, index: Sequence[int]) -> str:
        """Entry in words: "point 3, step 4"."""
        parts = [] if member is None else [f"{MEMBER} {member}"]
        pairs = zip(self.axes.items(), index, strict=False)
        return ", ".join(parts + [f"{name} {values[at]:g}" for (name, values), at in pairs])


class _Read(NamedTuple):
    """Forecasts of one form in a file, not yet checked."""

    form: _Form
    blocks: Iterable[FloatArray]  #: values ``(points, steps, values)`` of each member
    where: Callable[[int, tuple[int, ...]], str]  #: place of a member's value in words


def _forms(task: ForecastTask) -> list[_Form]:
    def axes(point: str, points: int, steps: int) -> dict[str, FloatArray]:
        return {point: np.arange(float(points)), "step": np.arange(1.0, steps + 1.0)}

    windows = axes("point", task.points, task.steps)
    horizon = axes("horizon_point", task.horizon_points, task.horizon_steps)
    times = {"prediction_time_lt": np.array(task.prediction_times_lt, dtype=np.float64)}
    names = component_names(task.space)
    return [
        _Form("observable", windows, ("observable",)),
        _Form("state", windows, names),
        _Form("probability", {"point": windows["point"], **times}, ("probability",)),
        _Form("horizon_observable", horizon, ("observable",)),
        _Form("horizon_state", horizon, names),
    ]


def facts_of(path: Path) -> Facts:
    """Read the case that a file of forecasts belongs to, and nothing else."""
    suffix = path.suffix.lower()
    if suffix not in (*_CSV, *_NETCDF):
        raise ForecastFileError(f"{path}: files of forecasts end in .csv or .nc")
    try:
        if suffix in _CSV:
            with open(path, encoding="utf-8-sig") as file:
                line = _FIRST_LINE.fullmatch(file.readline())
            if line is None:
                raise ForecastFileError(
                    f"{path}, line 1: expected is the line # case=NAME case_version=... seed=..., "
                    f"as the page of the task has it"
                )
            given: Sequence[Any] = line.groups()
        else:
            with netCDF4.Dataset(path, "r") as opened:
                missing = [name for name in _FACTS if name not in opened.ncattrs()]
                if missing:
                    raise ForecastFileError(
                        f"{path} has no global attribute {missing[0]!r}; expected are "
                        f"{', '.join(_FACTS)}, as in the file of the task"
                    )
                given = [opened.getncattr(name) for name in _FACTS]
    except UnicodeError as error:
        raise ForecastFileError(f"{path} is not written in UTF-8 ({error})") from error
    except OSError as error:
        raise ForecastFileError(f"{path} cannot be read: {error.strerror or error}") from error
    try:
        return Facts(str(given[0]), str(given[1]), int(given[2]))
    except (TypeError, ValueError):
        raise ForecastFileError(f"{path}: seed must be a whole number, not {given[2]}") from None


def read_forecasts(paths: Sequence[Path], task: ForecastTask) -> Forecasts:
    """Read and check all files of one forecaster.

    ``paths``: Files of forecasts for the windows, and for the prediction horizon.
    """
    members: tuple[WindowSummaries, ...] = ()
    probability: FloatArray | None = None
    horizon: FloatArray | None = None
    source: dict[str, str] = {}
    for path in paths:
        version = facts_of(path).case_version
        if version != task.version:
            raise ForecastFileError(
                f"{path} is of version {version} of the case {task.case}, and version "
                f"{task.version} is scored: export the case again, and forecast from the new "
                f"washouts"
            )
        read = _csv if path.suffix.lower() in _CSV else _netcdf
        for one in read(path, _forms(task)):
            form = one.form
            if form.subject in source:
                raise ForecastFileError(
                    f"{path} has forecasts of the {form.subject} ({form.name}), and so has "
                    f"{source[form.subject]}: give one of them"
                )
            source[form.subject] = f"{path} ({form.name})"
            observables = (_observable(task, form, block) for block in _checked(one))
            if form.members:
                members = tuple(summarise(each.T, task.boundaries) for each in observables)
            elif form.name == "probability":
                (probability,) = observables
            else:
                (horizon,) = observables
    if "windows" not in source:
        raise ForecastFileError(
            f"{' and '.join(map(str, paths))} must have forecasts of the windows: one of "
            f"observable, state and probability"
        )
    return Forecasts(members, probability, horizon)


def _observable(task: ForecastTask, form: _Form, block: FloatArray) -> FloatArray:
    """Observable ``(points, steps)`` of a member's forecasts ``(points, steps, values)``."""
    if not form.components:
        return block[..., 0]
    return task.space.observable(np.moveaxis(block, -1, 0))


def _checked(read: _Read) -> Iterator[FloatArray]:
    """Values of each member: finite, and probabilities between 0 and 1."""
    for member, block in enumerate(read.blocks):
        bad, expected = ~np.isfinite(block), "expected is a finite number"
        if read.form.name != "probability":
            expected += " (also after a forecast has diverged)"
        elif not bad.any():
            bad, expected = (block < 0) | (block > 1), "expected is a probability between 0 and 1"
        if bad.any():
            index = tuple(int(place) for place in np.argwhere(bad)[0])
            column, value = read.form.columns[index[-1]], block[index]
            raise ForecastFileError(
                f"{read.where(member, index)}: {column} is {value:g}; {expected}"
            )
        yield block


# -- NetCDF ----------------------------------------------------------------------------------------


def _netcdf(path: Path, forms: Sequence[_Form]) -> Iterator[_Read]:
    known = {form.name: form for form in forms}
    labels = list(known["state"].columns)
    counting = {name: values for form in forms[::-1] for name, values in form.axes.items()}
    counting["horizon_step"] = known["horizon_state"].axes["step"]
    with netCDF4.Dataset(path, "r") as file:
        for name, variable in file.variables.items():
            if name in known:
                _check_shape(path, known[name], variable)
            elif name in counting:
                # the shape first: a file may declare more than fits into memory
                same = variable.shape == counting[name].shape and _is_numeric(variable)
                if not same or not np.array_equal(np.asarray(variable[...], float), counting[name]):
                    told = [f"{value:g}" for value in counting[name]]
                    shown = told if len(told) < 4 else [*told[:2], "...", told[-1]]
                    raise ForecastFileError(f"{path}: {name} must count {', '.join(shown)}")
            elif name == "component":
                read = variable[...] if variable.shape == (len(labels),) else np.empty(0)
                found = list(map(str, np.asarray(read).tolist()))
                if found not in (labels, list(map(str, range(len(labels))))):
                    raise ForecastFileError(
                        f"{path}: component must be {', '.join(labels)}, in this order"
                    )
            elif name != MEMBER:
                raise ForecastFileError(
                    f"{path}: unknown variable {name!r}{suggestion(name, list(known))}; forecasts "
                    f"are {', '.join(known)}"
                )
        for name in known.keys() & file.variables.keys():
            yield _variable(path, known[name], file.variables[name])


def _check_shape(path: Path, form: _Form, variable: Any) -> None:
    """Check the dimensions of a variable, and that it has numbers."""
    found = list(zip(variable.dimensions, variable.shape, strict=True))
    expected = [(name.removesuffix("_lt"), len(values)) for name, values in form.axes.items()]
    expected += [("component", len(form.columns))] * form.components
    rest = found[1:] if form.members and found and found[0][0] == MEMBER else found
    alike = [[(name.removeprefix("horizon_"), one) for name, one in a] for a in (rest, expected)]
    if alike[0] != alike[1] or not variable.size:
        told, wanted = (", ".join(f"{name} {one}" for name, one in a) for a in (found, expected))
        raise ForecastFileError(
            f"{path}: {form.name} has the dimensions ({told}); expected is ({wanted})"
        )
    if not _is_numeric(variable):
        raise ForecastFileError(f"{path}: {form.name} has no numbers, but {variable.dtype}")


def _is_numeric(variable: Any) -> bool:
    return isinstance(variable.dtype, np.dtype) and variable.dtype.kind in "fiu"


def _variable(path: Path, form: _Form, variable: Any) -> _Read:
    several = variable.dimensions[0] == MEMBER

    def block(member: int) -> FloatArray:
        read = np.ma.asarray(variable[member] if several else variable[...], dtype=np.float64)
        filled: FloatArray = read.filled(np.nan)  # what was never written is missing
        return filled if form.components else filled[..., np.newaxis]

    def where(member: int, index: tuple[int, ...]) -> str:
        return f"{path}, {form.name} of {form.place(member if several else None, index)}"

    return _Read(form, map(block, range(variable.shape[0] if several else 1)), where)


# -- CSV -------------------------------------------------------------------------------------------


def _csv(path: Path, forms: Sequence[_Form]) -> Iterator[_Read]:
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeError as error:
        raise ForecastFileError(f"{path} is not written in UTF-8 ({error})") from error
    header = ",".join(name.strip() for name in "".join(lines[1:_LINES_BEFORE]).split(","))
    known = {",".join((*form.axes, *form.columns)): form for form in forms}
    known |= {f"{MEMBER},{text}": form for text, form in known.items() if form.members}
    if header not in known:
        raise ForecastFileError(
            f"{path}, line 2: the header is {header!r}{_hint(header)}; expected is one of "
            f"{'; '.join(known)}"
        )
    form, several = known[header], header.startswith(MEMBER)
    values = _numbers(path, header.split(","), lines[_LINES_BEFORE:])
    axes = dict(form.axes)
    if several:
        axes = {MEMBER: np.arange(float(len(np.unique(values[:, 0])))), **axes}
    order = _ordered(path, axes, values[:, : len(axes)])
    shape = (-1, *map(len, form.axes.values()))
    found = values[order, len(axes) :].reshape(*shape, len(form.columns))

    def where(member: int, index: tuple[int, ...]) -> str:
        line = int(order.reshape(shape)[(member, *index[:2])]) + _LINES_BEFORE + 1
        return f"{path}, line {line} ({form.place(member if several else None, index)})"

    yield _Read(form, found, where)


def _hint(text: str) -> str:
    return " (fields are separated by commas)" if re.search(r"[;\t]", text) else ""


def _numbers(path: Path, header: Sequence[str], rows: Sequence[str]) -> FloatArray:
    """Numbers of all rows, ``(rows, columns)``."""
    if not rows:
        raise ForecastFileError(f"{path} has a header, but no rows")
    try:
        found = np.loadtxt(rows, delimiter=",", comments=None, ndmin=2)
    except ValueError:
        found = np.empty((0, 0))
    if found.shape == (len(rows), len(header)):
        return found
    for line, row in enumerate(rows, _LINES_BEFORE + 1):
        fields = row.split(",")
        if len(fields) != len(header):
            raise ForecastFileError(
                f"{path}, line {line} has {len(fields) if row.strip() else 'no'} fields"
                f"{_hint(row)}; expected are {len(header)}: {','.join(header)}"
            )
        for name, text in zip(header, fields, strict=True):
            try:
                float(text)
            except ValueError:
                raise ForecastFileError(
                    f"{path}, line {line}: {name} is {text!r}; expected is a number"
                ) from None
    raise ForecastFileError(f"{path} cannot be read as a table of numbers")


def _ordered(path: Path, axes: dict[str, FloatArray], given: FloatArray) -> IntArray:
    """Rows in the order of their entries ``(rows, axes)``, each of which must be there once."""
    for (name, counted), column in zip(axes.items(), given.T, strict=True):
        if (wrong := ~np.isin(column, counted)).any():
            row, listed = int(wrong.argmax()), ", ".join(f"{value:g}" for value in counted)
            if name == MEMBER:
                listed = "members 0, 1, ... without a gap"
            elif len(counted) > 6:
                listed = f"whole numbers from {counted[0]:g} to {counted[-1]:g}"
            raise ForecastFileError(
                f"{path}, line {row + _LINES_BEFORE + 1}: {name} is {column[row]:g}; expected are "
                f"{listed}"
            )
    expected = pd.MultiIndex.from_product(list(axes.values()))
    keys = expected.get_indexer(pd.MultiIndex.from_arrays(list(given.T)))

    def told(key: int) -> str:
        return ", ".join(f"{name} {v:g}" for name, v in zip(axes, expected[key], strict=True))

    if len(again := np.flatnonzero(pd.Index(keys).duplicated())):
        second, first = int(again[0]), int((keys == keys[again[0]]).argmax())
        raise ForecastFileError(
            f"{path}, line {second + _LINES_BEFORE + 1} gives {told(keys[second])} again, after "
            f"line {first + _LINES_BEFORE + 1}; expected is one row for each"
        )
    if missing := len(expected) - len(keys):
        gap = int(np.isin(np.arange(len(expected)), keys).argmin())
        raise ForecastFileError(
            f"{path} has no row for {told(gap)}: {missing} of {len(expected)} rows are missing"
        )
    return np.argsort(keys, kind="stable")
