"""Records as they were measured: with gaps, over several files, by a clock.

A record is brought to runs without a break (`burstcast.data.measured_data.Run`), which are cut into
series as all others are.
"""

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any
from zoneinfo import available_timezones

import numpy as np

from burstcast.arrays import BoolArray, FloatArray, IntArray, float_array, is_known
from burstcast.data.cycles import (
    Cycle,
    calendar_names,
    with_calendar,
    with_waves,
    without_cycle,
)
from burstcast.data.measured_data import (
    Blocks,
    Quantity,
    Run,
    block_starts,
    blocks_of,
    check_equidistant,
    check_numbers,
    series_of_runs,
)
from burstcast.data.series_files import read_runs
from burstcast.data.time_stamps import duration_in
from burstcast.discovery import suggestion
from burstcast.systems.measured import MeasuredSeries

TOLERANCE = 0.1
"""Largest distance of a time stamp from the regular times of its run, in time steps: clocks jitter,
and beyond it a run ends, so that no run drifts away from them."""


@dataclass(frozen=True)
class Timing:
    """When the rows of a record were measured."""

    step: float  #: time between two rows, in time units
    #: name of the column of times; None if there is none, and no row is missing
    column: str | None = None
    unit: str = "time unit"  #: what a time unit is called in messages: "minute"

    def of(self, run: Run) -> FloatArray:
        """Times of the rows of a run."""
        if self.column is None:
            return np.arange(_length(run)) * np.float64(self.step)
        return run.columns[self.column]


class Record:
    """Rows of one run, or of several files one after the other.

    ``runs``: The runs, in their order in time, with the same columns.
    """

    def __init__(self, runs: Sequence[Run]) -> None:
        self._names = [run.name for run in runs]
        self._first = np.cumsum([0, *map(_length, runs)])
        self.columns: dict[str, FloatArray] = {
            name: np.concatenate(
                [float_array(run.columns[name], f"{run.name}: column {name!r}") for run in runs]
            )
            for name in runs[0].columns
        }

    def place(self, row: int) -> str:
        """Place of a row, for messages: "lab.csv, row 3"."""
        part = int(np.searchsorted(self._first, row, side="right")) - 1
        return f"{self._names[part]}, row {row - self._first[part] + 1}"

    def rows(self, first: int, last: int) -> str:
        """Name of the rows from one to another, both included."""
        ends = self.place(first), self.place(last)
        file = ends[0].rpartition(", row ")[0]
        if ends[1].startswith(f"{file}, row "):
            return f"{file}, rows {ends[0].rpartition(' ')[2]} to {ends[1].rpartition(' ')[2]}"
        return " to ".join(ends)

    def run(self) -> Run:
        """The record as one run."""
        return Run(self.rows(0, int(self._first[-1]) - 1), self.columns)


def check_rising(record: Record, timing: Timing) -> None:
    """Check that time goes forward from each row of a record to the next."""
    if timing.column is None:
        return
    time, column = record.columns[timing.column], f"column {timing.column!r}"
    if not np.isfinite(time).all():
        row = int(np.flatnonzero(~np.isfinite(time))[0])
        raise ValueError(f"{record.place(row)}: {column} has no time; each row needs one")
    steps = np.diff(time)
    if not (steps > 0).all():
        row = int(np.flatnonzero(steps <= 0)[0])
        back = f"goes back by {-steps[row]:g} {timing.unit}s from" if steps[row] else "stays at"
        raise ValueError(
            f"{record.place(row + 1)}: {column} {back} the time of {record.place(row)}; times must "
            f"rise. Remove rows that are there twice; if a clock was put back, write times in UTC, "
            f"or with their offsets from it"
        )


def runs_without_gaps(record: Record, timing: Timing, longest: float = 0.0) -> list[Run]:
    """Cut a record at its gaps.

    A row is complete if it has numbers in all columns. Two complete rows belong together if they
    are a time step apart; if they are several steps apart, there is a gap between them. A time that
    does not fit the regular times of its run by more than `TOLERANCE` begins another run.

    ``record``: With the columns that are needed alone; infinite numbers are errors. ``longest``:
    Longest time between two complete rows that is filled by linear interpolation, in time units; 0
    fills none. Numbers that an incomplete row has are kept.
    """
    check_rising(record, timing)
    time = timing.of(record.run())
    values = {name: column for name, column in record.columns.items() if name != timing.column}
    known = {name: is_known(column) for name, column in values.items()}
    for name, column in values.items():
        if np.isinf(column).any():
            row = int(np.isinf(column).argmax())
            raise ValueError(
                f"{record.place(row)}: column {name!r} is infinite; write nan for gaps"
            )
    complete = np.flatnonzero(np.all(list(known.values()), axis=0))
    found = []
    for rows in _parts(time, complete, timing.step, longest):
        inside = np.arange(rows[0], rows[-1] + 1)
        steps = (time[inside] - time[inside[0]]) / timing.step
        place = np.round(steps)
        fits = np.abs(steps - place) <= TOLERANCE
        regular = np.arange(place[-1] + 1)
        columns = {
            name: _filled(column[inside], place, fits & known[name][inside], regular)
            for name, column in values.items()
        }
        if timing.column is not None:
            columns[timing.column] = time[inside[0]] + timing.step * regular
        found.append(Run(record.rows(rows[0], rows[-1]), columns))
    return found


def _length(run: Run) -> int:
    return len(next(iter(run.columns.values())))


def _parts(time: FloatArray, complete: IntArray, step: float, longest: float) -> list[list[int]]:
    """Rows of each run among the complete ones: those between which no gap is too long."""
    parts: list[list[int]] = []
    begin, last = 0.0, 0
    for row in complete.tolist():
        place = (time[row] - begin) / step
        number = round(place)
        ahead = number - last
        near = ahead == 1 or (ahead > 1 and ahead * step <= longest * (1 + 1e-9))
        if parts and near and abs(place - number) <= TOLERANCE:
            parts[-1].append(row)
            last = number
        else:
            parts.append([row])
            begin, last = float(time[row]), 0
    return parts


def _filled(
    column: FloatArray, place: FloatArray, known: BoolArray, regular: FloatArray
) -> FloatArray:
    """A column at regular places, linear between those where it is known."""
    if known.all() and np.array_equal(place, regular):
        return column
    return np.interp(regular, place[known], column[known])


def long_runs(runs: Sequence[Run], samples: int) -> tuple[list[Run], str]:
    """Runs that are as long as a block, and a sentence about the others, empty if there is none."""
    lengths = [_length(run) for run in runs]
    kept = [run for run, length in zip(runs, lengths, strict=True) if length >= samples]
    if not kept:
        most = f"the longest of {len(runs)} has {max(lengths)}" if runs else "there are none"
        raise ValueError(
            f"no rows without a gap between them are as many as a block (data.blocks.duration) "
            f"takes, {samples}: {most}"
        )
    short = [run for run, length in zip(runs, lengths, strict=True) if length < samples]
    if not short:
        return kept, ""
    rows, total = sum(map(_length, short)), sum(lengths)
    return kept, (
        f"gaps leave {len(runs)} parts of the record; {len(short)} of them, with {rows} of {total} "
        f"rows, are shorter than a block of {samples} and left out; the first is {short[0].name}"
    )


@dataclass(frozen=True)
class Treatment:
    """Treatment of records before they are cut into series."""

    timing: Timing  #: when rows were measured
    #: whether times are dates, or numbers in a unit that is stated: they must rise
    has_dates: bool = False
    joined: bool = False  #: whether all runs are parts of one record, in their order in time
    cut: bool = False  #: whether gaps cut a record; otherwise they are errors
    longest: float = 0.0  #: longest gap that is filled (`runs_without_gaps`), in time units
    cycle: Cycle | None = None  #: a cycle of the records; None if there is none
    waves: bool = True  #: whether its waves become columns
    removed_from: tuple[str, ...] = ()  #: columns that it is removed from

    @property
    def wave_names(self) -> tuple[str, ...]:
        """Columns that it adds."""
        return self.cycle.names if self.cycle is not None and self.waves else ()

    @property
    def is_plain(self) -> bool:
        """Whether runs stay as they are."""
        return not (self.has_dates or self.joined or self.cut or self.cycle)

    def __call__(
        self,
        runs: Sequence[Run],
        needed: Callable[[Sequence[str]], Sequence[str]],
        blocks: Blocks | None,
        training: int,
    ) -> tuple[list[Run], str]:
        """Bring records to runs without a break.

        ``needed``: Selection of columns, the column of times included. ``blocks``: How runs are cut
        into series; None for not at all. Returns the runs, and a sentence about what was left out,
        empty if nothing was.
        """
        timing, left_out = self.timing, ""
        taken = [
            Run(run.name, {name: run.columns[name] for name in needed(list(run.columns))})
            for run in runs
        ]
        records = [Record(taken)] if self.joined else [Record([run]) for run in taken]
        if self.cut:
            parts = [
                part for one in records for part in runs_without_gaps(one, timing, self.longest)
            ]
            found, left_out = long_runs(parts, blocks.samples if blocks else 1)
        else:
            for record in records:
                check_rising(record, timing)
                self._check_steps(record)
            found = [one.run() for one in records] if self.joined else taken
        if self.cycle is not None and timing.column is not None:
            if self.removed_from:
                for run, name in itertools.product(found, self.removed_from):
                    check_numbers(run.name, f"column {name!r}", run.columns[name])
                rows = training_rows([_length(run) for run in found], blocks, training)
                found = without_cycle(found, self.cycle, timing.column, self.removed_from, rows)
            if self.waves:
                found = with_waves(found, self.cycle, timing.column)
        return found, left_out

    def _check_steps(self, record: Record) -> None:
        column = self.timing.column
        if column is None:
            return
        steps = np.diff(record.columns[column])
        bad = np.abs(steps / self.timing.step - 1) > TOLERANCE
        if bad.any():
            row = int(bad.argmax())
            raise ValueError(
                f"{record.place(row + 1)}: column {column!r} is {steps[row]:g} {self.timing.unit}s "
                f"after {record.place(row)}, not a time step of {self.timing.step:g}: cut records "
                f"at their gaps (data.gaps: cut)"
            )


def training_rows(lengths: Sequence[int], blocks: Blocks | None, training: int) -> list[slice]:
    """Rows of each run that belong to the first series, for runs with such rows."""
    found, left = [], training
    for length in lengths:
        starts = block_starts(length, blocks) if blocks else range(1)
        taken = starts[:left]
        if not taken:
            break
        found.append(slice(0, taken[-1] + (blocks.samples if blocks else length)))
        left -= len(taken)
    return found


@dataclass(frozen=True)
class RecordedSeries:
    """Series of states as they were measured."""

    states: FloatArray  #: ``(series, time, component)``
    #: values that are known in advance, ``(series, time, column)``; None where there are none
    known: FloatArray | None = None
    #: time of the first sample of each series; None where rows are not treated by their times
    start: FloatArray | None = None
    left_out: str = ""  #: what was left out, in a sentence; empty if nothing was


def recorded_series(
    paths: Sequence[str],
    data: Mapping[str, Any],
    space: MeasuredSeries,
    step: float,
    training: int,
) -> RecordedSeries:
    """Read the series of a case from its files, checked."""
    time, blocks, treatment = data["time"], data["blocks"], treatment_of(data, step)
    cut = blocks and blocks_of(blocks["duration"], blocks["gap"], step)
    quantities, known = (list(map(Quantity, data[key])) for key in ("components", "known"))
    asked = [*quantities, *([Quantity(space.observable_of)] if space.appended else []), *known]
    asked += map(Quantity, [*treatment.removed_from, *([time] if time else [])])
    calendar = calendar_names(data["known"])
    waves = [*treatment.wave_names, *calendar]

    def needed(known: Sequence[str]) -> list[str]:
        names = dict.fromkeys(name for one in asked for name in one.columns([*known, *waves]))
        return [name for name in names if name in known or name not in waves]

    def of_runs(runs: Sequence[Run]) -> tuple[FloatArray, FloatArray | None]:
        states = series_of_runs(runs, space, quantities, cut)
        if not known:
            return states, None
        names = [one.name for one in known]
        return states, series_of_runs(runs, MeasuredSeries(names, names[0]), known, cut)

    runs = [run for path in paths for run in read_runs(path, data, needed)]
    if treatment.is_plain:
        for run in runs if time is not None else []:
            check_equidistant(run.name, time, Quantity(time).values(run.columns), step)
        return RecordedSeries(*of_runs(runs))
    runs, left_out = treatment(runs, needed, cut, training)
    start = None
    if time is not None:
        times = [run.columns[time] for run in runs]
        firsts = [one[list(block_starts(len(one), cut)) if cut else [0]] for one in times]
        start = np.concatenate(firsts)
        runs = with_calendar(runs, calendar, time, data["time_unit"])
    states, known_values = of_runs(runs)
    return RecordedSeries(states, known_values, start, left_out)


def treatment_of(data: Mapping[str, Any], step: float) -> Treatment:
    """Treatment of the records of a case: its section ``data``, and the time between two rows."""
    said, unit = data["cycle"], data["time_unit"]
    cycle = said and Cycle(duration_in(said["period"], unit), said["harmonics"])
    return Treatment(
        Timing(step, data["time"], unit or "time unit"),
        has_dates=unit is not None,
        joined=bool(data["joined"]),
        cut=data["gaps"] == "cut",
        longest=data["longest_interpolation"] or 0.0,
        cycle=cycle,
        waves=said is not None and said["components"],
        removed_from=tuple(said["removed_from"]) if said else (),
    )


def problems_of_known(data: Mapping[str, Any], columns: Sequence[str]) -> Iterator[str]:
    """Mistakes in the columns that a case's records have as known in advance.

    ``data``: What the records are, by the names that `recorded_series` reads. ``columns``: Columns
    of the first file; empty where that cannot be read. Returns messages that begin with the name in
    ``data`` that is wrong: "known has rho twice".
    """
    channels = list(map(Quantity, [*data["components"], data["observable"]]))
    taken = {text for one in channels for text in (one.name, one.source)}
    calendar, names = calendar_names(data["known"]), []
    if calendar and not data["time_unit"]:
        yield (
            f"known has {calendar[0]}, a wave of the calendar, which takes dates: give time and "
            f"time_unit"
        )
    for one in map(Quantity, data["known"]):
        if {one.name, one.source} & taken:
            yield (
                f"known has {one.declaration}, which forecasters see and forecast as a "
                f"component or the observable: leave it out there, or here"
            )
        elif one.name in names:
            yield f"known has {one.name} twice"
        elif columns:
            try:
                one.columns([*columns, *calendar, *filter(None, [data["time"]])])
            except ValueError as error:
                yield f"known: {error}"
        names.append(one.name)


_TOGETHER = {
    "time_unit": "time",
    "time_zone": "time_unit",
    "joined": "time",
    "cycle": "time",
    "gaps": "blocks",
    "longest_interpolation": "gaps",
}
"""Settings that need another one."""


def problems_of_treatment(data: Mapping[str, Any]) -> Iterator[str]:
    """Mistakes in the treatment of a case's records that its settings show.

    Parameters and messages are as of `problems_of_known`.
    """
    for key, other in _TOGETHER.items():
        if data[key] and not data[other]:
            yield f"{key} needs {other} beside it"
    zone, step = data["time_zone"], data["time_step"]
    if zone is not None and zone not in available_timezones():
        near = suggestion(zone, available_timezones())
        yield f"time_zone is {zone}, which is no time zone on this machine{near}"
    try:
        cycle = treatment_of(data, step).cycle
    except ValueError as error:
        yield f"cycle.period: {error}"
        return
    if cycle is not None and cycle.period <= 2 * cycle.harmonics * step:
        yield (
            f"cycle: {cycle.harmonics} harmonics of the period {cycle.period:g} take more "
            f"than {2 * cycle.harmonics} samples in it, at the time step {step:g}"
        )
