"""Measured records: checks, cuts at gaps, and conversion to series of states."""

import datetime
import itertools
import math
import numbers
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from burstcast.base.arrays import FloatArray, is_known
from burstcast.base.series_lengths import array_or_list, series_lengths
from burstcast.data.clocks import JITTER, check_rising, irregularity, rounding
from burstcast.data.containers import unpacked
from burstcast.data.measured_data import (
    Blocks,
    Quantity,
    Run,
    check_varying,
    code_of_gaps,
    series_of_runs,
)
from burstcast.data.series_files import content_of
from burstcast.data.series_layout import check_units
from burstcast.data.tables import RECIPES
from burstcast.data.times import TIME, time_step_of
from burstcast.systems.measured import MeasuredSeries

_ROUNDED = (
    f"where times are rounded, write each as the number of its row times the time step ({RECIPES})"
)
_MANY = 10  # rows, of which gaps alone hardly leave each by itself
_NO_GAP = 1.5  # time steps between two rows without another between them, at most
TOLERANCE = 0.1
"""Largest distance of a row's time from the regular times of its run, in time steps.

Clocks jitter by less; a row further away begins another run, so that no run drifts."""


@dataclass(frozen=True)
class RecordedSeries:
    """Series of states as they were measured."""

    states: FloatArray  #: ``(series, time, component)``; shorter series end with NaN
    #: values that are known in advance, ``(series, time, column)``; None where there are none
    covariates: FloatArray | None = None
    #: time of the first sample of each series; None where rows have no times, or these do not rise
    start: FloatArray | None = None
    messages: tuple[str, ...] = ()  #: what was left out, and which lengths series have
    drift: tuple[str, ...] = ()  #: runs that are cut without a gap, by a wrong time step


def measured_series(
    sources: Any,
    time_step: float | str | datetime.timedelta,
    components: Sequence[str] = (),
    *,
    block: float | None = None,
    gap: float = 0.0,
    shortest: float | None = None,
    cut_gaps: bool = False,
) -> FloatArray | list[FloatArray]:
    """Series of measured records, checked and cut as a campaign does it.

    Parameters
    ----------
    sources
        A table of pandas with a column ``time`` or an index of times; an array or a data set of
        xarray with dimensions series, time and component, of which only time must be there; the
        path of a file; or a list of these (`burstcast.data.containers` has other containers).
    time_step
        Time between two rows; with a unit where times are dates: "5 minutes", or a Timedelta.
    components
        Columns, expressions of columns, or ``name = expression``; by default all columns.
    block, gap
        Length of each series, and time between two of them, in time units; None: one of each run.
    shortest
        Length of the shortest series, in time units: what is left of a run beside its blocks is a
        series from this length on. None: all series are as long as a block.
    cut_gaps
        Whether missing rows and NaN cut a record into runs; otherwise they are errors.

    Returns
    -------
    ``(series, time, component)``, or a list of series ``(time, component)`` if their lengths
    differ. What are no numbers in equal steps is a ValueError with the row; where ``cut_gaps`` cuts
    at rows between which none is missing, since the time step is another one, a UserWarning says
    so.

    Examples
    --------
    >>> import numpy as np
    >>> import pandas as pd
    >>> from burstcast.data.records import measured_series
    >>> times = pd.date_range("2020-01-01", periods=100, freq="h", name="time")
    >>> table = pd.DataFrame({"load": np.sin(np.arange(100.0))}, index=times)
    >>> measured_series(table, "1 hour", block=24).shape
    (4, 25, 1)
    """
    if cut_gaps and block is None and shortest is None:
        raise ValueError(
            "cut_gaps needs block, the length of the series, or shortest, their least length, both "
            "in the unit of time_step"
        )
    if isinstance(components, str):
        raise TypeError(f"components must be a list: [{components!r}]")
    for name, length in (("block", block), ("gap", gap), ("shortest", shortest)):
        is_number = isinstance(length, numbers.Real) and not isinstance(length, bool)
        if length is not None and not (is_number and math.isfinite(length)):
            raise TypeError(f"{name} must be a number, in time units of the record, not {length!r}")
    if gap < 0 or any(length is not None and not length > 0 for length in (block, shortest)):
        raise ValueError(
            f"block and shortest must be above 0, and gap not below it, not {block!r}, "
            f"{shortest!r} and {gap!r}"
        )
    listed = unpacked(sources, "the sources")
    if not isinstance(listed, list) or not listed:
        raise TypeError(
            f"series come from a file, a table of pandas, what xarray holds, or a list of these, "
            f"not from {type(sources).__name__}"
        )
    declared = components
    if not declared:
        content = content_of(listed[0])
        content.check_all_taken()
        declared = content.names
    data = {
        "time_step": time_step,
        "components": declared,
        "known": (),
        "gaps": "cut" if cut_gaps else None,
        "blocks": {"duration": block, "gap": gap, "shortest": shortest}
        if block is not None or shortest is not None
        else None,
    }
    names = [Quantity(text).name for text in declared]
    recorded = recorded_series(listed, data, MeasuredSeries(names, names[0]))
    for message in recorded.drift:
        warnings.warn(message, stacklevel=2)
    return array_or_list(recorded.states)


def recorded_series(
    sources: Sequence[Any], data: Mapping[str, Any], space: MeasuredSeries
) -> RecordedSeries:
    """Series of states of a case from its sources, checked.

    ``data``: Section ``data`` of the case, with its ``components``.
    """
    step, unit = time_step_of(data["time_step"])
    quantities, in_advance = (list(map(Quantity, data[key])) for key in ("components", "known"))
    appended = [Quantity(space.observable_of)] if space.appended else []
    runs: list[Run] = []
    for number, source in enumerate(sources, 1):
        content = content_of(source, number if len(sources) > 1 else None)
        runs += content.read(content.columns_of([*quantities, *appended, *in_advance]), unit)
    for run in runs:
        _check_codes(run)
        _check_units(run, runs[0])
    blocks = None
    if lengths := data["blocks"]:
        blocks = Blocks.of(lengths["duration"], lengths["gap"], lengths.get("shortest"), step)
    messages: list[str] = []
    drift: list[str] = []
    if data["gaps"] == "cut":
        parts: list[Run] = []
        for run in runs:
            parts += (parts_of_run := runs_without_gaps(run, step))
            drift += _drift(run, parts_of_run, step)
        shortest = blocks.shortest if blocks else 1
        try:
            runs = long_runs(parts, shortest)
        except ValueError as error:
            raise ValueError("; ".join([str(error), *drift])) from None
        messages += _left_out(parts, shortest)
    else:
        for run in runs:
            check_regular(run, step)
    states = series_of_runs(runs, space, quantities, blocks)
    check_varying(states, space.component_names, f"the series of {runs[0].name} and all others")
    messages += _lengths(states, runs, blocks)
    covariates = start = None
    if in_advance:
        names = [quantity.name for quantity in in_advance]
        covariates = series_of_runs(runs, MeasuredSeries(names, names[0]), in_advance, blocks)
    if all(TIME in run.columns for run in runs):
        start = np.array(
            [
                run.columns[TIME][block.start]
                for run in runs
                for block in (blocks.of_run(run.length) if blocks else [slice(0, None)])
            ]
        )
        start = start if (np.diff(start) > 0).all() else None
    return RecordedSeries(states, covariates, start, tuple(messages), tuple(drift))


def _drift(run: Run, parts: Sequence[Run], step: float) -> Iterator[str]:
    """A sentence about parts that begin without a gap, since times are off, if there are any."""
    if TIME not in run.columns:
        return
    ends = [part.columns[TIME][[0, -1]] for part in parts]
    drifted = sum(
        later[0] - earlier[1] < _NO_GAP * step for earlier, later in itertools.pairwise(ends)
    )
    steps = np.diff(run.columns[TIME])
    mean = steps[steps < _NO_GAP * step].mean() if drifted else step
    if drifted:
        yield (
            f"{run.name}: {drifted} of {len(parts)} parts begin without a gap, where times are off "
            f"by more than a tenth of the time step, {step:g}. The mean step is {mean:.10g}: write "
            f"that (data.time_step); {_ROUNDED}"
        )


def _left_out(parts: Sequence[Run], shortest: int) -> Iterator[str]:
    """A sentence about the parts between gaps that are too short for a series, if there are any."""
    short = [part for part in parts if part.length < shortest]
    if short:
        yield (
            f"gaps leave {len(parts)} parts of the record; {len(short)} of them, with "
            f"{sum(part.length for part in short)} of {sum(part.length for part in parts)} rows, "
            f"are shorter than a series of {shortest} and left out; the first is {short[0].name}"
        )


def _lengths(states: FloatArray, runs: Sequence[Run], blocks: Blocks | None) -> Iterator[str]:
    """Sentences about rows that fill no block, and about unequal lengths."""
    rows = [blocks.left_over(run.length) if blocks else 0 for run in runs]
    if any(rows):
        yield (
            f"{sum(rows)} of {sum(run.length for run in runs)} rows, at the ends of "
            f"{np.count_nonzero(rows)} of {len(runs)} runs, are too few for a series and left out"
        )
    if (lengths := series_lengths(states)) is not None:
        yield f"{len(lengths)} series have {lengths.min()} to {lengths.max()} samples"


def _check_units(run: Run, first: Run) -> None:
    """Check that columns have the units that they have in the first run, where both have one."""
    names = [name for name in run.columns if name != TIME]
    units = [tuple(of.units.get(name, "") for name in names) for of in (run, first)]
    check_units(run.name, tuple(names), units[0], first.name, units[1])


def _check_codes(run: Run) -> None:
    for name, column in run.columns.items():
        if np.isnan(column).all():
            raise ValueError(f"{run.name}: column {name!r} has no number at all: leave it out")
        code = None if name == TIME else code_of_gaps(column)
        if code is not None:
            raise ValueError(
                f"{run.name}: column {name!r} has the value {code:g} in {(column == code).sum()} "
                f"rows, far from all others, which looks like a code for missing numbers: write "
                f"nan (pandas: read_csv(na_values=[{code:g}]))"
            )


def check_regular(run: Run, step: float) -> None:
    """Check that all rows lie at regular times, a time step apart (`times.irregularity`)."""
    if TIME not in run.columns:
        return
    check_rising(run.name, run.columns[TIME])
    time = run.columns[TIME]
    fault = irregularity(time, step)
    if fault is None:
        return
    row = fault.row
    if fault.kind == "step":
        off = np.abs((time - time[0]) / step - np.arange(len(time))) > JITTER
        row = int(off.argmax()) or 1
        advice = f"it has no gap; write data.time_step: {fault.mean:.10g}"
    elif fault.kind == "gap":
        advice = "cut records at their gaps (data.gaps: cut)"
    else:
        advice = (
            f"its rate changes: the mean step is {fault.before:.6g} up to row {row + 1}, and "
            f"{fault.after:.6g} from there on: give parts of one rate as records of their own, or "
            f"resample ({RECIPES})"
        )
    raise ValueError(
        f"{run.name}, row {row + 1}: column {TIME!r} goes on by {time[row] - time[row - 1]:g} "
        f"from row {row}, and by {time[row] - time[0]:g} from row 1; the time step is "
        f"{step:g}, and the mean step of the record {fault.mean:g}: {advice}"
    )


def runs_without_gaps(run: Run, step: float) -> list[Run]:
    """Cut a record at its gaps.

    A row is complete if it has numbers in all columns. Neighbouring complete rows belong together
    if they are a time step apart; a time further than `TOLERANCE` from the regular times of its run
    begins another run. The times of the resulting runs are exactly regular.
    """
    timed = TIME in run.columns
    if timed:
        check_rising(run.name, run.columns[TIME])
    time = run.columns[TIME] if timed else np.arange(run.length) * np.float64(step)
    complete = np.ones(run.length, dtype=bool)
    for name, column in run.columns.items():
        if np.isinf(column).any():
            row = int(np.isinf(column).argmax()) + 1
            raise ValueError(f"{run.name}, row {row}: {name!r} is infinite; write nan for gaps")
        complete &= is_known(column)
    rows = np.flatnonzero(complete)
    runs: list[Run] = []
    apart = np.flatnonzero((np.abs(np.diff(time[rows]) / step - 1) > 0.5) | (np.diff(rows) > 1))
    for piece in np.split(rows, apart + 1):
        while len(piece):
            count = _regular(time[piece], step)
            part = run.rows(int(piece[0]), int(piece[count - 1]))
            if timed:
                regular = part.columns[TIME][0] + step * np.arange(count)
                part = Run(part.name, {**part.columns, TIME: regular}, part.units)
            runs.append(part)
            piece = piece[count:]
    if len(runs) == len(rows) >= _MANY:  # hardly gaps alone
        apart_by = float(np.median(np.diff(time[rows])))
        raise ValueError(
            f"{run.name}: no two rows are the time step (data.time_step), {step:g}, apart; most "
            f"are {apart_by:g} apart"
        )
    return runs


def _regular(time: FloatArray, step: float) -> int:
    """Number of leading times that are regular, at least 1; searched in growing parts."""
    length, tolerance = 64, TOLERANCE + rounding(time) / step
    while True:
        places = (time[:length] - time[0]) / step
        fits = np.abs(places - np.arange(len(places))) <= tolerance
        if not fits.all():
            return int(fits.argmin())
        if length >= len(time):
            return len(time)
        length *= 4


def long_runs(runs: Sequence[Run], samples: int) -> list[Run]:
    """Runs of at least ``samples`` rows."""
    kept = [run for run in runs if run.length >= samples]
    if not kept:
        longest = max((run.length for run in runs), default=0)
        most = f"the longest of {len(runs)} has {longest}" if runs else "there are none"
        raise ValueError(
            f"no rows without a gap between them are as many as a series takes, {samples} "
            f"(data.blocks, duration or shortest): {most}"
        )
    return kept


def problems_of_columns(data: Mapping[str, Any], names: Sequence[str]) -> Iterator[str]:
    """Mistakes in the columns that a case declares as known in advance.

    ``names``: Columns of the first file; empty if it cannot be read. Messages begin with the
    setting in ``data`` that is wrong: "known has rho twice".
    """
    channels = list(map(Quantity, [*data["components"], data["observable"]]))
    taken = {text for channel in channels for text in (channel.name, channel.source)}
    seen: list[str] = []
    for covariate in map(Quantity, data["known"]):
        if {covariate.name, covariate.source} & taken:
            yield (
                f"known has {covariate.declaration}, which forecasters see and forecast as a "
                f"component or the observable: leave it out there, or here"
            )
        elif covariate.name in seen:
            yield f"known has {covariate.name} twice"
        elif names:
            try:
                covariate.columns(names)
            except ValueError as error:
                yield f"known: {error}"
        seen.append(covariate.name)
