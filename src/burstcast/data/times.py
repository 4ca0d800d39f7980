"""Times of the rows of a record: numbers, or dates (ISO 8601) in units of time since 1970."""

import re
from collections.abc import Sequence

import numpy as np
import pandas as pd

from burstcast.arrays import FloatArray

TIME = "time"
"""Name of the column, the variable or the axis of times."""

SECONDS = {"second": 1, "minute": 60, "hour": 3600, "day": 86400}
"""Units of time for records with dates, in seconds; each has a constant length."""

_STEP = re.compile(rf"(\d+(?:\.\d+)?) ?({'|'.join(SECONDS)})s?", re.ASCII)
_DATE = re.compile(
    r"\d{4}-\d\d-\d\d(?:[T ]\d\d:\d\d(?::\d\d(?:\.\d{1,6})?)?(Z|[+-]\d\d:?\d\d)?)?", re.ASCII
)


def time_step_of(given: float | str) -> tuple[float, str | None]:
    """Time between two rows, and its unit where the times are dates.

    Examples
    --------
    >>> time_step_of("5 minutes"), time_step_of(0.02)
    ((5.0, 'minute'), (0.02, None))
    """
    if not isinstance(given, str):
        return float(given), None
    found = _STEP.fullmatch(given)
    if found is None or not float(found[1]):
        raise ValueError(
            f"{given!r} is no time step: write a number above 0, or one with second, minute, hour "
            f"or day, such as 5 minutes"
        )
    return float(found[1]), found[2]


def times_of(texts: Sequence[str], unit: str | None) -> FloatArray:
    """Times of a column of text: numbers as they are, dates in a unit since 1970-01-01 UTC.

    All rows have numbers, or dates, or dates with an offset from UTC. Dates without one count as
    UTC. An error begins with the row in brackets, counted from 0: "[3] has no time".
    """
    if is_number(texts[0]):
        return np.array([_number(text, row) for row, text in enumerate(texts)])
    if unit is None and _DATE.fullmatch(texts[0]):
        raise ValueError(
            f"[0] has the date {texts[0]!r}, but the time step has no unit: write it with one, "
            f"such as time_step: 5 minutes"
        )
    matches = [_DATE.fullmatch(text) for text in texts]
    kinds = [match and match[1] is not None for match in matches]
    if len(set(kinds)) > 1 or None in kinds:
        row = next(row for row, kind in enumerate(kinds) if kind is None or kind != kinds[0])
        is_other = kinds[row] is not None or is_number(texts[row])
        raise ValueError(_no_time(texts[row], row, is_other=is_other))
    try:
        moments = pd.to_datetime(list(texts), format="ISO8601", utc=True)
    except ValueError:  # no such day or hour
        row = next(row for row, text in enumerate(texts) if _impossible(text))
        raise ValueError(f"[{row}] has {texts[row]!r}, which is no date of the calendar") from None
    assert unit is not None
    return moments_in(moments, unit)


def moments_in(moments: pd.DatetimeIndex, unit: str) -> FloatArray:
    """Moments in units of time since 1970-01-01 UTC; without a zone, they count as UTC."""
    if moments.tz is not None:
        moments = moments.tz_convert("UTC")
    # whole microseconds: the quotient is rounded once
    values = moments.as_unit("us").asi8 / (SECONDS[unit] * 1_000_000)
    return np.where(moments.isna(), np.nan, values)


def times_since(values: FloatArray, units: str, calendar: str, unit: str) -> FloatArray:
    """Times of a NetCDF file, "hours since 2020-03-01 06:00", in a unit since 1970-01-01 UTC."""
    # UDUNITS puts a zone after a blank: "2020-03-01 06:00 +01:00"
    found = re.fullmatch(r"(\w+?)s? since (\S+(?: [\d:.]+)?)(?: ?(\S.*))?", units.strip())
    if found is None or found[1] not in SECONDS:
        raise ValueError(
            f"has the units {units!r}; with a unit in the time step, they must be seconds, "
            f"minutes, hours or days since a date"
        )
    if calendar not in ("standard", "gregorian", "proleptic_gregorian"):
        raise ValueError(
            f"has the calendar {calendar}: write a time step without a unit, and times as numbers"
        )
    try:
        zone = re.sub(r"^(UTC|GMT|Z)$", "", found[3] or "")
        written = found[2].removesuffix("Z") + zone
        origin = pd.to_datetime([written], format="ISO8601", utc=True)
    except ValueError:
        raise ValueError(
            f"has the units {units!r}, whose date and zone are not written in ISO 8601"
        ) from None
    first = float(moments_in(origin, unit)[0])
    return first + values * (SECONDS[found[1]] / SECONDS[unit])


def is_number(text: str) -> bool:
    """Whether a field is a number; in files, Python's 1_000 is not."""
    try:
        float("" if "_" in text or not text.isascii() else text)
    except ValueError:
        return False
    return True


def _number(text: str, row: int) -> float:
    if not is_number(text):
        raise ValueError(_no_time(text, row, is_other=_DATE.fullmatch(text) is not None))
    return float(text)


def _no_time(text: str, row: int, *, is_other: bool) -> str:
    if not text.strip():
        return f"[{row}] has no time; each row needs one"
    if is_other:
        return f"[{row}] has {text!r}, which is of another form than the rows before"
    return (
        f"[{row}] has {text!r}, which is neither a number nor a date as ISO 8601 writes it, such "
        f"as 2010-03-24, 2010-03-24T09:51 or 2010-03-24T09:51:00+01:00"
    )


def _impossible(text: str) -> bool:
    try:
        pd.to_datetime([text], format="ISO8601", utc=True)
    except ValueError:
        return True
    return False
