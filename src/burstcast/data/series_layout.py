"""The one layout of series: ``(series, time, component)``.

Whatever takes series from a user takes them like this, as an array of NumPy or of xarray:

========= ===========================================================================
series    realisations, each observed on its own; a single one is ``series[np.newaxis]``
time      samples at equal intervals, one step of a forecast each
component what is observed of the state, in units of its own
========= ===========================================================================

What xarray holds has dimensions of these names in any order, of which only time must be there. A
table of pandas is one series, and so is each entry of a list of tables or arrays: columns go by
their names. A coordinate, a column or an index of times has neither gaps nor another interval.
`burstcast.data.containers` has other containers.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from numbers import Real
from pathlib import Path
from typing import Any, NamedTuple
from unicodedata import normalize

import numpy as np

from burstcast.base.arrays import AXES, FloatArray, float_array, is_known
from burstcast.base.series_lengths import padded
from burstcast.data.clocks import check_rising, irregularity
from burstcast.data.containers import is_labelled, unpacked

_STEP_TOLERANCE = 0.01
"""Of the mean interval of a clock, relative to the interval that is expected."""
_STEP_JITTER = 0.5
"""By which the last time may be off from its place on a clock of the expected interval."""


class LabelledRun(NamedTuple):
    """One series as tables and arrays of xarray have it."""

    labels: tuple[str, ...] | None  #: names of components; None: they have none
    states: FloatArray  #: ``(time, component)``
    times: FloatArray | None = None  #: times of the samples; None: not known
    dated: bool = False  #: whether times are in seconds, and not in the unit of their numbers
    units: tuple[str, ...] | None = None  #: units of components, "" where not known; None: none


@dataclass(frozen=True)
class LabelledSeries:
    """Series with the names of their components and the interval of their clock."""

    states: FloatArray  #: ``(series, time, component)``; shorter series end with NaN
    labels: tuple[str, ...] | None = None  #: names of components; None: they have none
    step: float | None = None  #: time between two samples by the clock; None: there is no clock
    dated: bool = False  #: whether the step is in seconds, and not in the unit of its numbers
    units: tuple[str, ...] | None = None  #: units of components, "" where not known; None: none

    def check_step(self, expected: float, name: str) -> None:
        """Check that the clock has the expected interval, which is called so in messages."""
        if self.step is not None and not _alike(self.step, expected, self.states.shape[1]):
            unit = " seconds" if self.dated else ""
            raise ValueError(
                f"the times of the series are {self.step:.6g}{unit} apart, but {name} is "
                f"{expected:.6g}{unit}"
            )

    def check_units(self, expected: tuple[str, ...] | None) -> None:
        """Check that components have the units of the training series, where both are known.

        ``expected``: Units of these components in the training series, by the same labels.
        """
        check_units("the series", self.labels, self.units, "the training series", expected)


def labelled_series(data: Any, what: str = "the series") -> LabelledSeries:
    """Copy series of a user, which may differ in length, with their labels and their clock.

    ``data``: An array of NumPy, or what can be made one, of shape ``(series, time, component)``; a
    table or a list of tables; an array or a data set of xarray; or a list of series of unequal
    lengths, ``(time, component)`` each.
    """
    data = unpacked(data, what)
    if not isinstance(data, list) or not data:
        return LabelledSeries(_checked(float_array(data, what), np.shape(data), what))
    if paths := [entry for entry in data if isinstance(entry, str | Path)]:
        raise TypeError(
            f"{what} must be arrays or tables, not the file {str(paths[0])!r}: read files by "
            f"burstcast.data.records.measured_series(path, time_step)"
        )
    if any(map(is_labelled, data)):
        runs = [run for source in data for run in _runs(source, what)]
        labels, units = runs[0].labels, runs[0].units
        runs = [_by_label(run, labels, what) for run in runs]
        for number, run in enumerate(runs[1:], 2):
            check_units(f"series {number}", labels, run.units, "series 1", units)
        states = _side_by_side([run.states for run in runs], what)
        return LabelledSeries(states, labels, *_clock(runs, what), units)
    lengths = {
        len(series)
        for series in data
        if getattr(series, "shape", None) != () and hasattr(series, "__len__")
    }
    if len(lengths) < 2:
        return LabelledSeries(_checked(float_array(data, what), np.shape(data), what))
    return LabelledSeries(_side_by_side([float_array(series, what) for series in data], what))


class Observation(NamedTuple):
    """One observation of a running series as a user has it."""

    values: FloatArray  #: ``(component,)``
    labels: tuple[str, ...] | None  #: of its components; None: they have none
    time: Any = None  #: when it was made, as a number or a date; None: not known
    row: int | None = None  #: number of its row in a table without times; None: not known


def observation_of(data: Any) -> Observation:
    """One observation with the labels of its components, and the time that it carries.

    ``data``: An array of NumPy, a row of a table of pandas, a dictionary, or what xarray holds of
    one time, with the dimension component.
    """
    what = "the observation"
    if hasattr(data, "iloc"):
        row = data.iloc[0] if data.ndim == 2 and len(data) == 1 else data
        values = dict(zip(map(str, row.index), row, strict=True))
        name, time = getattr(row, "name", None), values.pop("time", None)
        if time is None and isinstance(name, tuple):
            raise ValueError(f"{what} has the label {name!r} of several levels: give its time")
        row_number = None
        if time is None and isinstance(name, int | np.integer) and not isinstance(name, bool):
            row_number = int(name)
        numbers = row.drop(index=["time"]) if len(values) < len(row) else row
        return Observation(
            float_array(np.asarray(numbers, dtype=None if time is None else float), what),
            tuple(values),
            name if time is None and row_number is None else time,
            row_number,
        )
    if hasattr(data, "dims"):
        data = (data.to_dataarray("component") if hasattr(data, "data_vars") else data).squeeze()
        labels = None
        if "component" in data.coords and data.ndim:
            labels = labels_of(data.coords["component"].values)
        time = data.coords["time"].values[()] if "time" in data.coords else None
        return Observation(float_array(data, what), labels, time)
    if isinstance(data, Mapping):
        values = {str(label): value for label, value in data.items()}
        time = values.pop("time", None)
        return Observation(float_array(list(values.values()), what), tuple(values), time)
    return Observation(float_array(data, what), None)


def labels_of(entries: Any) -> tuple[str, ...]:
    """Labels of components from the entries of a coordinate; those of stacked dimensions are pairs.

    Examples
    --------
    >>> labels_of(np.array([1.0, 2.5])), labels_of(np.array(["u", "v"]))
    (('c1', 'c2.5'), ('u', 'v'))
    >>> import pandas as pd
    >>> labels_of(pd.MultiIndex.from_product([["u"], [10.0, 20.0]]).values)
    ('u_10', 'u_20')
    """
    if entries.dtype.kind in "iuf":
        return tuple(f"c{entry:g}" for entry in entries)
    if entries.dtype.kind == "O" and all(isinstance(entry, tuple) for entry in entries):
        return tuple(map(_label_of_parts, entries))
    return tuple(map(str, entries.astype(str)))


def _label_of_parts(parts: tuple[Any, ...]) -> str:
    """Label of a component with an entry of each stacked dimension."""
    texts = [f"{part:g}" if isinstance(part, Real) else str(part) for part in parts]
    return ("c" if isinstance(parts[0], Real) else "") + "_".join(texts)


def _runs(data: Any, what: str) -> Iterator[LabelledRun]:
    """Series of an array of xarray, a table of pandas, or an array ``(time, component)``."""
    if hasattr(data, "dims"):
        from burstcast.data.named_arrays import NamedArrays

        yield from NamedArrays(what, data).labelled_runs()
    elif hasattr(data, "iloc"):
        from burstcast.data.tables import labelled_run

        yield labelled_run(what, data)
    else:
        yield LabelledRun(None, float_array(data, what))


def _by_label(run: LabelledRun, labels: tuple[str, ...] | None, what: str) -> LabelledRun:
    """A series with its components in the order of some labels."""
    if run.labels == labels:
        return run
    if run.labels is None or labels is None:
        return run._replace(units=None)  # of which components is not known
    if sorted(run.labels) != sorted(labels):
        raise ValueError(
            f"{what} have different components: {', '.join(labels)} and {', '.join(run.labels)}"
            f"{nearly_the_same(labels, run.labels)}"
        )
    places = [run.labels.index(label) for label in labels]
    units = tuple(run.units[place] for place in places) if run.units else None
    return run._replace(labels=labels, states=run.states[:, places], units=units)


def nearly_the_same(labels: Sequence[str], others: Sequence[str]) -> str:
    """Words on labels that look alike but are other texts, for messages; empty if there are none.

    Examples
    --------
    >>> nearly_the_same(["u", "v"], ["u", "v "])
    "; 'v' and 'v ' differ in blanks alone: rename one"
    """
    for label in labels:
        for other in others:
            if label == other or _seen(label) != _seen(other):
                continue
            in_blanks = _without_blanks(label) == _without_blanks(other) or (
                normalize("NFC", label) != normalize("NFC", other)
                and "".join(label.split()) == "".join(other.split())
            )
            how = "blanks" if in_blanks else "how their characters are composed"
            return f"; {label!r} and {other!r} differ in {how} alone: rename one"
    return ""


def _seen(label: str) -> str:
    return _without_blanks(normalize("NFKC", label))


def _without_blanks(label: str) -> str:
    return "".join(sign for sign in label if not sign.isspace() and sign.isprintable())


def check_units(
    what: str,
    labels: tuple[str, ...] | None,
    units: tuple[str, ...] | None,
    other: str,
    expected: tuple[str, ...] | None,
) -> None:
    """Check that the units of components are the same texts in two series, where both have one."""
    for place, (unit, its) in enumerate(zip(units or (), expected or (), strict=False)):
        if unit and its and unit != its:
            name = labels[place] if labels else f"component {place}"
            raise ValueError(
                f"{name!r} has the unit {unit!r} in {what} and {its!r} in {other}: convert one of "
                f"them"
            )


def _clock(runs: list[LabelledRun], what: str) -> tuple[float | None, bool]:
    """Interval of the clocks of all series, and whether it is in seconds."""
    timed = [(run, run.times) for run in runs if run.times is not None and len(run.times) > 1]
    steps = [_step(times, run.dated, what) for run, times in timed]
    for (run, step), (following, its_step) in pairwise(
        zip((run for run, _ in timed), steps, strict=True)
    ):
        samples = min(len(run.states), len(following.states))
        if run.dated != following.dated or not _alike(its_step, step, samples):
            raise ValueError(
                f"{what} have clocks of different steps, {step:.6g} and {its_step:.6g}"
            )
    return (float(np.mean(steps)), timed[0][0].dated) if steps else (None, False)


def _step(times: FloatArray, dated: bool, what: str) -> float:
    """Mean interval of a clock without gaps, of one rate (`times.irregularity`)."""
    check_rising(what, times)
    fault = irregularity(times)
    if fault is None:
        return float((times[-1] - times[0]) / (len(times) - 1))
    before, after = (
        np.datetime64(round(time * 1e6), "us") if dated else f"{time:.6g}"
        for time in times[fault.row - 1 : fault.row + 1].tolist()
    )
    unit = " seconds" if dated else ""
    if fault.kind == "gap":
        raise ValueError(
            f"{what}: samples are {fault.before:.6g}{unit} apart, but not those "
            f"at the times {before} and {after}: give the runs between gaps as a list of series "
            f"(burstcast.data.records.measured_series cuts them: cut_gaps=True)"
        )
    raise ValueError(
        f"{what}: the rate of samples changes: up to the time {before} they are {fault.before:.6g}"
        f"{unit} apart, and {fault.after:.6g}{unit} from {after} on: give parts of one rate as "
        f"records of their own, or resample; if each row follows the row before it whatever its "
        f"time, as trading days do, leave the times out"
    )


def _alike(step: float, expected: float, samples: int) -> bool:
    tolerance = max(_STEP_TOLERANCE, _STEP_JITTER / max(1, samples - 1))
    return abs(step - expected) <= tolerance * expected


def _side_by_side(series: list[FloatArray], what: str) -> FloatArray:
    """Series ``(time, component)`` in one array, checked."""
    shapes = [states.shape for states in series]
    if any(len(shape) != 2 or shape[1] != shapes[0][-1] for shape in shapes):
        raise ValueError(
            f"each of {what} must be (time, component) with the same components, not "
            f"{', '.join(map(str, dict.fromkeys(shapes)))}"
        )
    if short := [row for row, shape in enumerate(shapes) if not shape[0]]:
        raise ValueError(f"{what} are empty: series {short[0]} has no sample")
    for row, states in enumerate(series):
        _check_finite(states[np.newaxis], what, row)
    return padded(series)


def _checked(array: FloatArray, shape: tuple[int, ...], what: str) -> FloatArray:
    series = np.array(array, order="C")
    if len(shape) != len(AXES):
        single = "series[np.newaxis]" if len(shape) == 2 else "series[np.newaxis, :, np.newaxis]"
        hint = f": a single series is {single}" if len(shape) < 3 else ""
        raise ValueError(f"{what} must be ({', '.join(AXES)}), not {shape}{hint}")
    if series.size == 0:
        raise ValueError(f"{what} of shape {series.shape} are empty")
    _check_finite(series, what)
    return series


def _check_finite(series: FloatArray, what: str, first: int = 0) -> None:
    missing = ~is_known(series)
    if missing.any():
        row, step, component = (int(index) for index in np.argwhere(missing)[0])
        raise ValueError(
            f"{what} must be finite: series {first + row} is {series[row, step, component]:g} at "
            f"step {step}, component {component}"
        )
