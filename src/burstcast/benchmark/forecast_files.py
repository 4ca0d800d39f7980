"""Forecasts of others as files, NetCDF or CSV: read strictly, or not at all.

The page of an export (``page.md``) says what such a file is. Whatever is wrong with one is one
message that names the file, the row, and what was expected.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import netCDF4
import numpy as np
import pandas as pd

from burstcast.arrays import FloatArray, IntArray
from burstcast.benchmark.cases import BenchmarkCase, case_named
from burstcast.benchmark.task import ForecastTask
from burstcast.discovery import suggestion
from burstcast.forecast.windows import WindowSummaries, summarise
from burstcast.systems.state_space import component_names

MEMBER = "member"
CSV, NETCDF = (".csv",), (".nc", ".nc4")
_FACTS = ("case", "case_version", "seed")
_FIRST_LINE = re.compile(r"#\s*case=(\S+)\s+case_version=(\S+)\s+seed=(\S+)\s*")
_TIME_COLUMN = "prediction_time_lt"


class ForecastFileError(ValueError):
    """A file of forecasts that is not what a case asks for."""


class Facts(NamedTuple):
    """Case that forecasts belong to. Versions are numbers in the benchmark, digests elsewhere."""

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


@dataclass(frozen=True)
class _Form:
    """A form that forecasts may have."""

    name: str  #: name of the variable in NetCDF
    #: dimensions after the dimension of members, with the values that count their entries
    axes: tuple[tuple[str, FloatArray], ...]
    columns: tuple[str, ...]  #: names of the values in CSV
    components: bool  #: whether the last dimension in NetCDF counts the components
    members: bool  #: whether there may be several members

    @property
    def of_horizon(self) -> bool:
        """Whether it is about the prediction horizon."""
        return self.axes[0][0] == "horizon_point"

    @property
    def header(self) -> list[str]:
        """Header of a CSV file, without members."""
        return [*(name for name, _ in self.axes), *self.columns]


def _forms(task: ForecastTask) -> list[_Form]:
    points = ("point", np.arange(float(task.points)))
    horizon_points = ("horizon_point", np.arange(float(task.horizon_points)))
    steps = ("step", np.arange(1.0, task.steps + 1.0))
    horizon_steps = ("step", np.arange(1.0, task.horizon_steps + 1.0))
    times = (_TIME_COLUMN, np.array(task.prediction_times_lt, dtype=np.float64))
    names = component_names(task.space)
    return [
        _Form("observable", (points, steps), ("observable",), False, True),
        _Form("state", (points, steps), names, True, True),
        _Form("probability", (points, times), ("probability",), False, False),
        _Form("horizon_observable", (horizon_points, horizon_steps), ("observable",), False, False),
        _Form("horizon_state", (horizon_points, horizon_steps), names, True, False),
    ]


def facts_of(path: Path) -> Facts:
    """Read the case that a file of forecasts belongs to, and nothing else."""
    suffix = path.suffix.lower()
    if suffix not in (*CSV, *NETCDF):
        raise ForecastFileError(f"{path}: files of forecasts end in .csv or .nc")
    try:
        if suffix in CSV:
            with open(path, encoding="utf-8-sig") as file:
                found = _FIRST_LINE.fullmatch(file.readline())
            if found is None:
                raise ForecastFileError(
                    f"{path}, line 1: expected is the line # case=NAME case_version=1 seed=2026, "
                    f"as the page of the export has it"
                )
            given: Sequence[Any] = found.groups()
        else:
            with netCDF4.Dataset(path, "r") as opened:
                missing = [name for name in _FACTS if name not in opened.ncattrs()]
                if missing:
                    raise ForecastFileError(
                        f"{path} has no global attribute {missing[0]!r}; expected are "
                        f"{', '.join(_FACTS)}, as in the file of the case"
                    )
                given = [opened.getncattr(name) for name in _FACTS]
    except UnicodeError as error:
        raise ForecastFileError(f"{path} is not written in UTF-8 ({error})") from error
    except OSError as error:
        raise ForecastFileError(f"{path} cannot be read: {error.strerror or error}") from error
    try:
        return Facts(str(given[0]), _version(given[1]), int(given[2]))
    except (TypeError, ValueError):
        raise ForecastFileError(f"{path}: seed must be a whole number, not {given[2]}") from None


def _version(value: Any) -> str:
    """Version of a case in words: 3 and 3.0 are equal."""
    number = isinstance(value, int | float | np.number) and float(value).is_integer()
    return str(int(value) if number else value)


def case_of(paths: Sequence[Path]) -> tuple[BenchmarkCase, int]:
    """Case and seed that files of one forecaster are of."""
    found = [facts_of(path) for path in paths]
    for path, facts in zip(paths, found, strict=True):
        if facts != found[0]:
            raise ForecastFileError(
                f"{path} is of {_told(facts)}, {paths[0]} of {_told(found[0])}: score them apart"
            )
        try:
            case = case_named(facts.case)
        except ValueError as error:
            raise ForecastFileError(f"{path}: {error}") from None
        check_version(path, facts, str(case.version))
        if facts.seed < 0:
            raise ForecastFileError(f"{path}: the seed must not be negative, not {facts.seed}")
    return case, found[0].seed


def check_version(path: Path, facts: Facts, version: str) -> None:
    """Check that forecasts are of one version of their case."""
    if facts.case_version != version:
        raise ForecastFileError(
            f"{path} is of version {facts.case_version} of the case {facts.case}, and version "
            f"{version} is scored: export the case again, and forecast from the new washouts"
        )


def _told(facts: Facts) -> str:
    return f"the case {facts.case}, version {facts.case_version}, seed {facts.seed}"


def read_forecasts(paths: Sequence[Path], task: ForecastTask) -> Forecasts:
    """Read and check all files of one forecaster.

    ``paths``: Files of forecasts for the windows, and for the prediction horizon.
    """
    members: tuple[WindowSummaries, ...] = ()
    probability: FloatArray | None = None
    horizon: FloatArray | None = None
    source: dict[bool, str] = {}
    for path in paths:
        check_version(path, facts_of(path), task.version)
        read = _csv if path.suffix.lower() in CSV else _netcdf
        for form, blocks in read(path, _forms(task)):
            if form.of_horizon in source:
                raise ForecastFileError(
                    f"{path} has forecasts of the {_subject(form)} ({form.name}), and so has "
                    f"{source[form.of_horizon]}: give one of them"
                )
            source[form.of_horizon] = f"{path} ({form.name})"
            if form.name == "probability":
                (probability,) = (block[..., 0] for block in blocks)
                continue
            observables = (_observable(task, form, block) for block in blocks)
            if form.of_horizon:
                (horizon,) = observables
            else:
                members = tuple(summarise(one.T, task.boundaries) for one in observables)
    if False not in source:
        raise ForecastFileError(
            f"{' and '.join(map(str, paths))} must have forecasts of the windows: one of "
            f"observable, state and probability"
        )
    return Forecasts(members, probability, horizon)


def _subject(form: _Form) -> str:
    return "prediction horizon" if form.of_horizon else "windows"


def _observable(task: ForecastTask, form: _Form, block: FloatArray) -> FloatArray:
    """Observable ``(points, steps)`` of a member's forecasts ``(points, steps, values)``."""
    if not form.components:
        return block[..., 0]
    return task.space.observable(np.moveaxis(block, -1, 0))


def _check_values(form: _Form, block: FloatArray, where: Callable[[tuple[int, ...]], str]) -> None:
    """Check values of one member: finite, and probabilities between 0 and 1."""
    bad = ~np.isfinite(block)
    expected = "expected is a finite number"
    if not form.name.startswith("probability"):
        expected += " (also after a forecast has diverged)"
    elif not bad.any():
        bad, expected = (block < 0) | (block > 1), "expected is a probability between 0 and 1"
    if bad.any():
        index = tuple(int(place) for place in np.argwhere(bad)[0])
        column = form.columns[index[-1]]
        raise ForecastFileError(f"{where(index)}: {column} is {block[index]:g}; {expected}")


def _place(form: _Form, index: Sequence[int], member: int | None = None) -> str:
    """Entry of a form in words: "point 3, step 4"."""
    parts = [] if member is None else [f"{MEMBER} {member}"]
    parts += [
        f"{name} {values[at]:g}" for (name, values), at in zip(form.axes, index, strict=False)
    ]
    return ", ".join(parts)


# -- NetCDF ----------------------------------------------------------------------------------------


def _netcdf(path: Path, forms: Sequence[_Form]) -> Iterator[tuple[_Form, Iterator[FloatArray]]]:
    """Forms in a file, with the values ``(points, steps, values)`` of each member."""
    known = {form.name: form for form in forms}
    counting: dict[str, Any] = {name: values for form in forms[::-1] for name, values in form.axes}
    counting["horizon_step"] = next(
        form.axes[1][1] for form in forms if form.name == "horizon_observable"
    )
    labels = next(list(form.columns) for form in forms if form.name == "state")
    with netCDF4.Dataset(path, "r") as file:
        for name, variable in file.variables.items():
            if name in known:
                _check_shape(path, known[name], variable)
            elif name in counting:
                expected = counting[name]
                # the shape first: a file may declare more than fits into memory
                same = variable.shape == expected.shape and _is_numeric(variable)
                if not same or not np.array_equal(np.asarray(variable[...], float), expected):
                    raise ForecastFileError(
                        f"{path}: {name} must count {expected[0]:g}, {expected[1]:g}, ..., "
                        f"{expected[-1]:g}"
                    )
            elif name == "component":
                read = variable[...] if variable.shape == (len(labels),) else np.empty(0)
                found = list(map(str, np.asarray(read).tolist()))
                if found != labels and found != list(map(str, range(len(labels)))):
                    raise ForecastFileError(
                        f"{path}: component must be {', '.join(labels)}, in this order"
                    )
            elif name != MEMBER:
                raise ForecastFileError(
                    f"{path}: unknown variable {name!r}{suggestion(name, list(known))}; forecasts "
                    f"are {', '.join(known)}"
                )
        for name in known.keys() & file.variables.keys():
            yield known[name], _members(path, known[name], file.variables[name])


def _check_shape(path: Path, form: _Form, variable: Any) -> None:
    expected = [(name, len(values)) for name, values in form.axes]
    expected[1] = ("prediction_time", expected[1][1]) if form.name == "probability" else expected[1]
    if form.components:
        expected.append(("component", len(form.columns)))
    found = list(zip(variable.dimensions, variable.shape, strict=True))
    if form.members and found and found[0][0] == MEMBER:
        if not found[0][1]:
            raise ForecastFileError(f"{path}: {form.name} has no member")
        found = found[1:]
    described = ", ".join(f"{name} {length}" for name, length in expected)
    lengths = ", ".join(f"{name} {length}" for name, length in found)
    names = [name.removeprefix("horizon_") for name, _ in found]
    if names != [name.removeprefix("horizon_") for name, _ in expected]:
        raise ForecastFileError(
            f"{path}: {form.name} has the dimensions ({lengths}); expected is ({described})"
        )
    for (name, length), (_, right) in zip(found, expected, strict=True):
        if length != right:
            what = f"{abs(length - right)} {'missing' if length < right else 'too many'}"
            raise ForecastFileError(
                f"{path}: {form.name} has {length} entries of {name}, {what}; expected is "
                f"({described})"
            )
    if not _is_numeric(variable):
        raise ForecastFileError(f"{path}: {form.name} has no numbers, but {variable.dtype}")


def _is_numeric(variable: Any) -> bool:
    return isinstance(variable.dtype, np.dtype) and variable.dtype.kind in "fiu"


def _members(path: Path, form: _Form, variable: Any) -> Iterator[FloatArray]:
    several = variable.dimensions[0] == MEMBER
    for member in range(variable.shape[0] if several else 1):
        read = np.ma.asarray(variable[member] if several else variable[...], dtype=np.float64)
        block = read.filled(np.nan)  # what was never written is missing
        block = block if form.components else block[..., np.newaxis]
        number = member if several else None

        def where(index: Sequence[int], number: int | None = number) -> str:
            return f"{path}, {form.name} of {_place(form, index, number)}"

        _check_values(form, block, where)
        yield block


# -- CSV -------------------------------------------------------------------------------------------

_LINES_BEFORE = 2


def _csv(path: Path, forms: Sequence[_Form]) -> Iterator[tuple[_Form, Iterator[FloatArray]]]:
    """The form of a file, with the values ``(points, steps, values)`` of each member."""
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeError as error:
        raise ForecastFileError(f"{path} is not written in UTF-8 ({error})") from error
    header = [name.strip() for name in lines[1].split(",")] if len(lines) > 1 else []
    form, several = _form_of(path, header, forms)
    values = _numbers(path, header, lines[_LINES_BEFORE:])
    axes = list(form.axes)
    if several:
        axes.insert(0, (MEMBER, np.arange(float(len(np.unique(values[:, 0]))))))
    order = _ordered(path, axes, values[:, : len(axes)])
    shape = (*(len(counted) for _, counted in axes[-2:]), len(form.columns))
    found = values[order, len(axes) :].reshape(-1, *shape)
    order = order.reshape(found.shape[:-1])
    for member, block in enumerate(found):

        def where(index: Sequence[int], member: int = member) -> str:
            line = int(order[(member, *index[:2])]) + _LINES_BEFORE + 1
            return f"{path}, line {line} ({_place(form, index, member if several else None)})"

        _check_values(form, block, where)
    yield form, iter(found)


def _form_of(path: Path, header: Sequence[str], forms: Sequence[_Form]) -> tuple[_Form, bool]:
    """Form that a header is of, and whether it has members."""
    known = {",".join(form.header): (form, False) for form in forms}
    known |= {",".join((MEMBER, *form.header)): (form, True) for form in forms if form.members}
    if (found := ",".join(header)) in known:
        return known[found]
    hint = " (fields are separated by commas)" if re.search(r"[;\t]", found) else ""
    raise ForecastFileError(
        f"{path}, line 2: the header is {found!r}{hint}; expected is one of {'; '.join(known)}"
    )


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
            hint = " (fields are separated by commas)" if re.search(r"[;\t]", row) else ""
            raise ForecastFileError(
                f"{path}, line {line} has {len(fields) if row.strip() else 'no'} fields{hint}; "
                f"expected are {len(header)}: {','.join(header)}"
            )
        for name, text in zip(header, fields, strict=True):
            try:
                float(text)
            except ValueError:
                raise ForecastFileError(
                    f"{path}, line {line}: {name} is {text!r}; expected is a number"
                ) from None
    raise ForecastFileError(f"{path} cannot be read as a table of numbers")


def _ordered(path: Path, axes: Sequence[tuple[str, FloatArray]], given: FloatArray) -> IntArray:
    """Rows in the order of their entries ``(rows, axes)``, each of which must be there once."""
    for (name, counted), column in zip(axes, given.T, strict=True):
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
    expected = pd.MultiIndex.from_product([counted for _, counted in axes])
    keys = expected.get_indexer(pd.MultiIndex.from_arrays(list(given.T)))

    def told(key: int) -> str:
        return ", ".join(f"{axes[at][0]} {value:g}" for at, value in enumerate(expected[key]))

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
