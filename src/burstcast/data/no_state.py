"""Columns that are no components of a state: numbers of runs, and counters of rows or of time."""

from collections.abc import Iterator, Sequence

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.base.series_lengths import without_padding
from burstcast.data.series_layout import LabelledSeries

_EQUAL = 1e-6
"""Largest difference of the steps of a counter, relative to their mean."""


def no_state(series: LabelledSeries) -> Iterator[str]:
    """A sentence about components that say which series or which row it is; none without any."""
    labels = series.labels or tuple(f"component {i}" for i in range(series.states.shape[2]))
    constant, counting = columns_of_no_state(labels, without_padding(series.states))
    if constant:
        yield (
            f"{_listed(constant)} constant in each series and another number in others, as the "
            f"number of a run is: that is no component of a state; leave it out "
            f"(table.drop(columns={constant}))"
        )
    if counting:
        yield (
            f"{_listed(counting)} rising or falling in equal steps in all series, as times and row "
            f"numbers do: that is no component of a state; leave it out "
            f"(table.drop(columns={counting})), or call it time"
        )


def _listed(names: Sequence[str]) -> str:
    return f"{', '.join(names)} {'is' if len(names) == 1 else 'are'}"


def columns_of_no_state(
    labels: Sequence[str], series: Sequence[FloatArray]
) -> tuple[list[str], list[str]]:
    """Columns that are constant in each series but not in all, and columns that count.

    ``series``: ``(time, component)`` each.

    Examples
    --------
    >>> rows = np.arange(9.0)
    >>> runs = [np.stack([np.sin(rows), np.full(9, run), rows], axis=1) for run in (1, 2)]
    >>> columns_of_no_state(["u", "run", "row"], runs)
    (['run'], ['row'])
    """
    constant, counting = [], []
    for place, label in enumerate(labels):
        columns = [states[:, place] for states in series if len(states) > 2]
        if len(columns) > 1 and all((column == column[0]).all() for column in columns):
            if len({float(column[0]) for column in columns}) > 1:
                constant.append(label)
        elif columns and all(map(_counts, columns)):
            counting.append(label)
    return constant, counting


def _counts(column: FloatArray) -> bool:
    """Whether values rise, or fall, in equal steps, but for rounding errors."""
    steps = np.diff(column)
    mean = (column[-1] - column[0]) / len(steps)
    rounding = 4 * np.spacing(np.abs(column).max())
    return bool(
        mean
        and (np.abs(steps - mean) <= _EQUAL * abs(mean) + rounding).all()
        and abs(mean) > 4 * rounding
    )
