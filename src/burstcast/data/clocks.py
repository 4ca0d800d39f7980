"""Clocks of series: times that rise in equal steps, and what keeps them from it."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from burstcast.base.arrays import FloatArray

SECONDS = {"second": 1, "minute": 60, "hour": 3600, "day": 86400}
"""Units of time for records with dates, in seconds; each has a constant length."""

JITTER = 0.5
"""Largest distance of a time from its place on a regular clock, in steps: less is jitter."""
_FEW_GAPS = 0.1
"""Share of odd steps up to which they are gaps, and not another rate."""

_UNITS_OF_DATES = {
    **{"millisecond": 1e-3, **SECONDS},
    **{"week": 7 * 86400, "month": 365.2425 * 7200, "year": 365.2425 * 86400},
}
_UNIT_TOLERANCE = 0.01

_LEAST_PERIOD = 10
"""Steps in the period of a clock that goes round, at least."""
_SHARED = 0.1
"""Least share of rows with the time of the row before that counts as rounding."""


@dataclass(frozen=True)
class Irregularity:
    """The first place where a clock is not that of equidistant samples."""

    kind: Literal["gap", "rate", "step"]  #: missing rows; another rate; another step than expected
    row: int  #: sample, counted from 0, before which it is seen
    mean: float  #: mean step of the whole clock
    before: float  #: typical step before the row
    after: float  #: the step that is odd, or the typical step from the row on


def irregularity(times: FloatArray, step: float | None = None) -> Irregularity | None:
    """What keeps rising times from being equidistant; None if they are.

    Equidistant times lie within `JITTER` steps of ``first + row * mean step``, so that each has its
    row: clocks that jitter and times that are rounded pass, and a rate that changes does not, since
    its deviations add up. ``step``: Expected one; None: any.
    """
    if len(times) < 2:
        return None
    steps = np.diff(times)
    mean, typical = float((times[-1] - times[0]) / (len(times) - 1)), float(np.median(steps))
    allowed = JITTER * typical + rounding(times)
    odd = np.abs(steps - typical) >= allowed
    away = np.abs(times - times[0] - mean * np.arange(len(times))) > allowed
    if odd.any() and int(odd.sum()) <= _FEW_GAPS * len(steps):
        row = int(odd.argmax())
        return Irregularity("gap", row + 1, mean, typical, float(steps[row]))
    if odd.any() or away.any():
        row = _change_of_rate(times)
        first, second = float(steps[:row].mean()), float(steps[row:].mean())
        return Irregularity("rate", row, mean, first, second)
    if step is not None and abs(mean - step) * (len(times) - 1) > JITTER * step + rounding(times):
        return Irregularity("step", 1, mean, mean, mean)
    return None


def _change_of_rate(times: FloatArray) -> int:
    """First sample of another rate: the farthest from the line of all times."""
    line = np.linspace(times[0], times[-1], len(times))
    return int(np.clip(np.abs(times - line).argmax(), 1, len(times) - 2))


def rounding(times: FloatArray) -> float:
    """Largest rounding error of a clock that was kept in single precision; else 0.

    Examples
    --------
    >>> rounding(np.array([1e5, 1e5 + 0.02])), rounding(np.array([1.0, np.float32(0.02)])) < 1e-6
    (0.0, True)
    """
    largest = np.abs(times).max(initial=0.0)
    if not len(times) or (times != times.astype(np.float32)).any() or (times % 1 == 0).all():
        return 0.0
    return float(np.spacing(np.float32(largest)))


def unit_of_dates(seconds: float, interval: float) -> str | None:
    """Unit of time in which an interval is that of dates, by its name; None if there is none.

    Examples
    --------
    >>> unit_of_dates(600.0, 10), unit_of_dates(600.0, 1 / 6), unit_of_dates(600.0, 1)
    ('minute', 'hour', None)
    >>> unit_of_dates(86400.0, 1 / 30.4), unit_of_dates(86400.0, 1 / 365)
    ('month', 'year')
    """
    for name, length in _UNITS_OF_DATES.items():
        if abs(seconds / (interval * length) - 1) <= _UNIT_TOLERANCE:
            return name
    return None


def readable(seconds: float) -> str:
    """A duration in the largest unit in which it is at least one.

    Examples
    --------
    >>> readable(600.0), readable(0.02), readable(86400.0)
    ('10 minutes', '0.02 seconds', '1 day')
    """
    unit = next((name for name in reversed(SECONDS) if seconds >= SECONDS[name]), "second")
    number = f"{seconds / SECONDS[unit]:.6g}"
    return f"{number} {unit}{'' if number == '1' else 's'}"


def check_rising(name: str, time: FloatArray) -> None:
    """Check that each row has a time, and that times rise from row to row."""
    if not np.isfinite(time).all():
        row = int(np.flatnonzero(~np.isfinite(time))[0]) + 1
        raise ValueError(f"{name}, row {row}: column 'time' has no time; each row needs one")
    steps = np.diff(time)
    if (steps > 0).all():
        return
    if (steps < 0).all() and len(steps) > 1:
        raise ValueError(
            f"{name}: the record is in falling order, the newest row first, but times must "
            f"rise: reverse it (pandas: table[::-1])"
        )
    if (steps >= 0).all() and (shared := int((steps == 0).sum())) >= max(3, _SHARED * len(time)):
        raise ValueError(
            f"{name}: {shared} of {len(time)} rows have the time of the row before them: times "
            f"are rounded. Write the time of each row as its number times the time step "
            f"(docs/data_recipes.md has recipes)"
        )
    row = int(np.flatnonzero(steps <= 0)[0])
    if period := _period_of_clock(time, row):
        raise ValueError(
            f"{name}, row {row + 2}: column 'time' goes back by {-steps[row]:.12g}, since a "
            f"clock went round: add {period} to the times from there on"
        )
    back = f"goes back by {-steps[row]:g} from" if steps[row] else "stays at"
    raise ValueError(
        f"{name}, row {row + 2}: column 'time' {back} the time of row {row + 1}; times must "
        f"rise. Remove rows that are there twice (pandas: table[~table.index.duplicated()], or "
        f"drop_duplicates('time')); if a clock was put back, write times in UTC, or "
        f"with their offsets from it"
    )


def _period_of_clock(time: FloatArray, row: int) -> str | None:
    """Period of a clock that counts from 0 again after a row, as text; None if it does not."""
    step = float(np.median(np.diff(time)))
    for bits in (16, 24, 31, 32):
        for unit, written in ((1.0, ""), (1e-3, " / 1000"), (1e-6, " / 1000000")):
            passed = time[row + 1] + 2**bits * unit - time[row]
            is_long = 2**bits * unit > _LEAST_PERIOD * step > 0
            if is_long and abs(passed - step) <= JITTER * step:
                return f"2**{bits}{written}"
    return None
