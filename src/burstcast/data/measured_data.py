"""Measured columns as an ensemble of series: selection and checks.

A run is what was measured without a break: a file, or a part of one. Each becomes one series, or
several blocks. One message reports an error with the run, the column and the row.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from unicodedata import normalize

import numpy as np

from burstcast.base.arrays import FloatArray, IntArray, float_array, is_known
from burstcast.base.discovery import suggestion
from burstcast.base.expressions import Expression
from burstcast.base.series_lengths import padded, samples_of, without_padding
from burstcast.data.laminarisation import first_laminar_step
from burstcast.systems.measured import MeasuredSeries


@dataclass(frozen=True)
class Run:
    """Columns that were measured side by side."""

    name: str  #: origin of the run, for messages: "run_3.csv"
    #: numbers by the names of their columns, each ``(time,)``; NaN where there is none
    columns: Mapping[str, FloatArray]
    units: Mapping[str, str] = field(default_factory=dict)  #: of columns, where they are known

    @property
    def length(self) -> int:
        """Number of rows."""
        return len(next(iter(self.columns.values())))

    def rows(self, first: int, last: int) -> "Run":
        """The rows from one to another, both included."""
        columns = {name: column[first : last + 1] for name, column in self.columns.items()}
        return Run(f"{self.name}, rows {first + 1} to {last + 1}", columns, self.units)


@dataclass(frozen=True)
class Content:
    """What a source of series has."""

    source: str  #: for messages: "run_3.csv"
    names: list[str]  #: of its columns without ``time``
    #: runs, by the names of columns, with the unit of dates; None where times are numbers
    read: Callable[[Sequence[str], str | None], list[Run]]
    #: variables with times and with other dimensions, which are no columns: "wind (time, latitude)"
    fields: tuple[str, ...] = ()

    def check_all_taken(self) -> None:
        """Check that all that has times is a column, where none are named."""
        if self.fields:
            raise ValueError(
                f"{self.source} has {', '.join(self.fields)} beside {', '.join(self.names)}: "
                f"rename the other dimension to component (.rename of xarray; .stack makes one "
                f"dimension of several), or leave these variables out (.drop_vars)"
            )

    def columns_of(self, quantities: "Sequence[Quantity]") -> list[str]:
        """Columns from which quantities are computed, each once."""
        try:
            columns = [name for quantity in quantities for name in quantity.columns(self.names)]
        except ValueError as error:
            raise ValueError(f"{self.source}: {error}") from None
        return list(dict.fromkeys(columns))


def runs_of_states(
    source: str, states: FloatArray, observable: FloatArray, components: Sequence[str]
) -> list[Run]:
    """Runs of series whose states are known: their components, and the column ``observable``.

    ``states``, ``observable``: ``(series, time, component)`` and ``(series, time)``.
    """
    return [
        Run(
            f"{source}, series {number}",
            {
                **dict(zip(components, series.T, strict=True)),
                "observable": values[: len(series)],
            },
        )
        for number, (series, values) in enumerate(
            zip(without_padding(states), observable, strict=True), 1
        )
    ]


def written_alike(name: str, available: Sequence[str]) -> str:
    """Words on a name that looks like another one, for messages; empty if there is none."""
    plain = "".join(normalize("NFKC", name).split())
    for column in available:
        if "".join(normalize("NFKC", column).split()) == plain:
            how = "blanks" if column.strip() == name.strip() else "characters"
            return f"; {column!r} is written with other {how}: copy it"
    return ""


@dataclass(frozen=True)
class Quantity:
    """Something that states are made of."""

    #: the name of a column, an expression of columns, or ``name = column or expression``
    declaration: str

    @property
    def name(self) -> str:
        """Name of the component."""
        name, equals, _ = self.declaration.partition("=")
        return name.strip() if equals else self.declaration.strip()

    @property
    def source(self) -> str:
        """The column or expression that it is taken from."""
        return self.declaration.partition("=")[2].strip() or self.name

    def columns(self, available: Sequence[str]) -> tuple[str, ...]:
        """Columns that it is made of."""
        if self.source in available:
            return (self.source,)
        try:
            names = Expression(self.source).names
        except ValueError as error:
            if self.source.isidentifier():
                names = (self.source,)
            else:
                inside = [
                    column
                    for column in available
                    if column in self.source and not column.isidentifier()
                ]
                hint = (
                    f": {max(inside, key=len)!r} can stand alone, but in an expression names have "
                    "letters, digits and _ only: rename the column in the record"
                    if inside
                    else ""
                )
                raise ValueError(f"there is no column {self.source!r}, and {error}{hint}") from None
        for name in names:
            if name not in available:
                hint = written_alike(name, available)
                raise ValueError(
                    f"there is no column {name!r}{hint or suggestion(name, available)}; "
                    f"the columns are {', '.join(available)}"
                )
        return names

    def values(self, columns: Mapping[str, FloatArray]) -> FloatArray:
        """Values of the quantity, ``(time,)``."""
        if self.source in columns:
            return columns[self.source]
        return Expression(self.source)(columns)


@dataclass(frozen=True)
class Blocks:
    """Lengths by which records are cut into series."""

    samples: int | None  #: number of samples of each block; None: of the whole run
    gap: int  #: samples from the last one of a block to the first one of the next, 1 at least
    #: samples of the shortest series; the rest of a run is a series from this length on
    shortest: int

    @classmethod
    def of(
        cls, duration: float | None, gap: float, shortest: float | None, time_step: float
    ) -> "Blocks":
        """Blocks of a duration, with gaps between them, in time units.

        Both ends of a block are samples, as in a simulated series. ``duration``: None: the whole
        run. ``shortest``: None: no block is shorter than the others.
        """
        samples, least = (
            None if length is None else round(length / time_step) + 1
            for length in (duration, shortest)
        )
        least = samples if least is None else least
        assert least is not None, "the duration of blocks, or of the shortest one"
        return cls(samples, max(1, math.ceil(gap / time_step - 1e-9)), least)

    def of_run(self, length: int) -> list[slice]:
        """Samples of each block of a run of some length."""
        samples = length if self.samples is None else self.samples
        starts = range(0, length - self.shortest + 1, samples - 1 + self.gap)
        return [slice(start, min(start + samples, length)) for start in starts]

    def left_over(self, length: int) -> int:
        """Samples at the end of a run of some length that do not make a block."""
        blocks = self.of_run(length)
        return max(0, length - blocks[-1].stop - (self.gap - 1)) if blocks else length


def series_of_runs(
    runs: Sequence[Run],
    space: MeasuredSeries,
    quantities: Sequence[Quantity],
    blocks: Blocks | None,
) -> FloatArray:
    """Series of states, ``(series, time, component)``: of each run, one after the other.

    ``quantities``: Components of a state, without the observable where that is a component of its
    own. ``blocks``: How runs are cut; None for one series from each. Shorter series end with NaN.
    """
    taken = [*quantities, *([Quantity(space.observable_of)] if space.appended else [])]
    series: list[FloatArray] = []
    for run in runs:
        try:
            needed = [quantity.columns(list(run.columns)) for quantity in taken]
        except ValueError as error:
            raise ValueError(f"{run.name}: {error}") from None
        for column in dict.fromkeys(name for names in needed for name in names):
            check_numbers(run.name, f"column {column!r}", run.columns[column])
        states = np.stack([quantity.values(run.columns) for quantity in taken], axis=1)
        for name, values in zip(space.component_names, states.T, strict=True):
            check_numbers(run.name, f"the component {name!r}", values)
        if blocks is None:
            series.append(states)
            continue
        if run.length < blocks.shortest:
            raise ValueError(
                f"{run.name} has {run.length} rows, but a block (data.blocks) takes "
                f"{blocks.shortest}"
            )
        series += [states[block] for block in blocks.of_run(run.length)]
    return padded(series)


def check_varying(series: FloatArray, names: Sequence[str], which: str) -> None:
    """Check that no component of ``(series, time, component)`` is constant.

    ``which`` series they are, for the message: "the training series".
    """
    for name, values in zip(names, samples_of(series).T, strict=True):
        if np.all(values == values[0]):
            raise ValueError(
                f"the component {name!r} is {values[0]:g} in all of {which}: a constant teaches "
                f"nothing, and inputs are divided by their range; leave it out"
            )


def check_numbers(run: str, what: str, values: FloatArray) -> None:
    """Check that all values are finite numbers."""
    values = float_array(values, f"{run}: {what}")
    bad = ~is_known(values)
    if bad.any():
        row, count = int(bad.argmax()), int(bad.sum())
        many = f" ({count} such rows in all)" if count > 1 else ""
        kind = "is infinite" if np.isinf(values[row]) else "has no number"
        raise ValueError(
            f"{run}: {what} {kind} in row {row + 1} of {len(values)}{many}: fill gaps, or cut the "
            f"record there (data.gaps: cut)"
        )


def code_of_gaps(values: FloatArray) -> float | None:
    """Value that stands for missing numbers by the looks of it: 99, -999.99; None if there is none.

    It is written with nines alone, repeats, and lies farther from all other values than these lie
    from each other.
    """
    numbers = values[is_known(values)]
    for extreme in (numbers.min(initial=np.inf), numbers.max(initial=-np.inf)):
        digits = f"{extreme:g}".lstrip("-").replace(".", "")
        if len(digits) < 2 or set(digits) != {"9"}:
            continue
        others = numbers[numbers != extreme]
        if len(numbers) - len(others) < 2 or not len(others):
            continue
        if np.abs(others - extreme).min() > np.ptp(others) > 0:
            return float(extreme)
    return None


def kept_series(observable: FloatArray, threshold: float | None) -> tuple[IntArray, IntArray]:
    """Series that do not exceed the laminarisation threshold, and lifetimes of all series.

    ``observable``: ``(series, time)``. ``threshold``: A series whose observable exceeds it is
    discarded; None keeps all. Returns numbers of the kept series, and the steps until each series
    exceeds it, all steps if it does not (`burstcast.data.dataset.KeptSeries`); steps that are NaN,
    after the end of a shorter series, are none.
    """
    first = first_laminar_step(observable, threshold)
    index = np.flatnonzero(first < 0)
    if index.size == 0:
        raise ValueError(
            f"all {len(observable)} series exceed laminarisation_threshold, {threshold}: raise it"
        )
    return index, np.where(first >= 0, first, (~np.isnan(observable)).sum(axis=1) - 1)
