"""Columns that are no components of a state: numbers of runs, counters of rows or time, clocks."""

from collections.abc import Iterator, Sequence
from typing import Literal, NamedTuple

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.series_lengths import without_padding
from burstcast.data.clocks import irregularity
from burstcast.data.series_layout import LabelledSeries

_EQUAL = 0.01
"""Largest difference of the steps of a counter, relative to their median."""
_MOSTLY = 0.8
"""Least share of equal steps in the direction of a counter: gaps are in the others."""
_REGULAR = 0.15
"""Largest difference of the times for which a clock shows one value, such as months."""
_FIRST = 0.05
"""Part of its range in which a cycle or a count of rows starts again."""
_LEAST_STARTS = 3
"""Different first values, at least, of a column that is constant in some series."""


class NoState(NamedTuple):
    """Names of columns that are no components of a state."""

    constant: list[str]  #: constant in each series, another number in others
    counting: list[str]  #: rising or falling in equal steps, each over one row or several
    cyclic: list[str]  #: rising or falling in equal steps, and starting again


def no_state(series: LabelledSeries) -> Iterator[str]:
    """A sentence about components that say which series or which row it is; none without any."""
    labels = series.labels or tuple(f"component {i}" for i in range(series.states.shape[2]))
    constant, counting, cyclic = columns_of_no_state(labels, without_padding(series.states))
    if constant:
        yield (
            f"{_listed(constant)} constant in each series and another number in others, as the "
            f"number of a run is: that is no component of a state; leave it out "
            f"(table.drop(columns={constant}))"
        )
    if counting:
        yield (
            f"{_listed(counting)} rising or falling in equal steps in all series, as times, years "
            f"and row numbers do: that is no component of a state; leave it out "
            f"(table.drop(columns={counting})), or, if it has the times of the rows, call it time"
        )
    if cyclic:
        yield (
            f"{_listed(cyclic)} rising in equal steps and then starting again, as the hour of the "
            f"day or the row numbers of joined tables do: that is no component of a state; leave "
            f"it out (table.drop(columns={cyclic})), or give the cosine and the sine of a cycle"
        )


def _listed(names: Sequence[str]) -> str:
    return f"{', '.join(names)} {'is' if len(names) == 1 else 'are'}"


def columns_of_no_state(labels: Sequence[str], series: Sequence[FloatArray]) -> NoState:
    """Columns that tell series, rows or times apart.

    ``series``: ``(time, component)`` each.

    Examples
    --------
    >>> rows = np.arange(48.0)
    >>> runs = [
    ...     np.stack([np.sin(rows), np.full(48, run), rows, rows // 12, rows % 24], axis=1)
    ...     for run in (1, 2)
    ... ]
    >>> columns_of_no_state(["u", "run", "row", "year", "hour"], runs)
    NoState(constant=['run'], counting=['row', 'year'], cyclic=['hour'])
    """
    found = NoState([], [], [])
    for place, label in enumerate(labels):
        columns = [states[:, place] for states in series if len(states) > 2]
        kinds = {_kind(column) for column in columns}
        if not columns or None in kinds:
            continue
        starts = len({float(column[0]) for column in columns})
        if kinds == {"constant"}:
            if starts > 1:
                found.constant.append(label)
        elif "constant" not in kinds or starts >= _LEAST_STARTS:
            (found.cyclic if "cyclic" in kinds else found.counting).append(label)
    return found


def _kind(column: FloatArray) -> Literal["constant", "counting", "cyclic"] | None:
    """What a column is, if it is no component of a state, but for rounding errors."""
    steps = np.diff(column)
    rounding = 4 * float(np.spacing(np.abs(column).max()))
    changes = np.abs(steps) > rounding
    if not changes.any():
        return "constant"
    if 2 * int((steps[changes] < 0).sum()) > int(changes.sum()):
        column, steps = -column, -steps
    rises, falls = steps[changes & (steps > 0)], changes & (steps < 0)
    typical = float(np.median(rises))
    equal = np.abs(rises - typical) <= _EQUAL * typical + rounding
    if not falls.any():
        is_clock = changes.all() and irregularity(column) is None
        return "counting" if is_clock or equal.mean() >= _MOSTLY else None
    starts = column[1:][falls]
    shown = np.diff(np.flatnonzero(changes))
    first = column.min() + max((1 + _EQUAL) * typical, _FIRST * np.ptp(column))
    is_cycle = (
        equal.mean() >= _MOSTLY
        and 2 * int(falls.sum()) <= len(rises)
        and bool((starts < first).all())
        and np.ptp(shown) <= max(1.0, _REGULAR * float(shown.max()))
    )
    return "cyclic" if is_cycle else None
