"""Times of the rows of a record: numbers, or dates (ISO 8601) in units of time since 1970."""

import datetime
import math
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from burstcast.base.arrays import FloatArray
from burstcast.data.clocks import SECONDS

if TYPE_CHECKING:
    import pandas as pd

TIME = "time"
"""Name of the column, the variable or the axis of times."""

_SPELLINGS: dict[str, float] = {"s": 1, "sec": 1, "min": 60, "h": 3600, "hr": 3600, "d": 86400}
_SPELLINGS |= {**SECONDS, "ms": 1e-3, "millisecond": 1e-3, "us": 1e-6, "microsecond": 1e-6}

_STEP = re.compile(rf"(\d+(?:\.\d+)?) ?({'|'.join(SECONDS)})s?", re.ASCII)
_DATE = re.compile(
    r"\d{4}(?:-\d\d-\d\d|\d{4}(?=T))"
    r"(?:[T ]\d\d(?::?\d\d(?::?\d\d(?:\.\d{1,9})?)?)?(Z|[+-]\d\d(?::?\d\d)?)?)?",
    re.ASCII,
)
# xarray takes months for dates without a day, drops single hours, and zones that it does not know
_SINCE = re.compile(
    r"\w+ since \d+-\d+-\d+(?:[T ] *\d+:\d+(?::\d+(?:\.\d+)?)?)?"
    r" *(?:Z|UTC|GMT|[+-]\d+(?::?\d\d)?)?",
    re.ASCII,
)


class TimesError(ValueError):
    """Times that are none, in a row counted from 0, or all of them."""

    def __init__(self, text: str, row: int | None = None) -> None:
        super().__init__(text)
        self.row = row


def time_step_of(given: float | str | datetime.timedelta) -> tuple[float, str | None]:
    """Time between two rows, and its unit where the times are dates.

    ``given``: A number, text, or a duration of Python, NumPy or pandas, which is in seconds then.

    Examples
    --------
    >>> import pandas as pd
    >>> time_step_of("5 minutes"), time_step_of(0.02), time_step_of(pd.Timedelta("1 min"))
    ((5.0, 'minute'), (0.02, None), (60.0, 'second'))
    """
    if isinstance(given, datetime.timedelta | np.timedelta64):
        import pandas as pd  # planning reads numbers and text alone

        seconds = pd.Timedelta(given).total_seconds()
        if not 0 < seconds < math.inf:
            raise ValueError(f"the time step must be above 0, not {given!r}")
        return seconds, "second"
    if not isinstance(given, str):
        if not 0 < given < math.inf:
            raise ValueError(f"the time step must be finite and above 0, not {given!r}")
        return float(given), None
    step = _STEP.fullmatch(given)
    if step is None or not float(step[1]):
        raise ValueError(
            f"{given!r} is no time step: write a number above 0, or one with second, minute, hour "
            f"or day, such as 5 minutes"
        )
    return float(step[1]), step[2]


def times_in(values: Any, unit: str | None) -> FloatArray:
    """Times of a table or an array: numbers as they are, dates in a unit since 1970-01-01 UTC.

    Dates without an offset from UTC count as UTC; durations are in the unit. ``unit``: None where
    the time step has none: times must be numbers then.
    """
    import pandas as pd

    column = pd.Series(values)
    kind = column.dtype
    if pd.api.types.is_numeric_dtype(kind) and kind.kind not in "bc":
        return column.to_numpy(dtype=np.float64, na_value=np.nan)
    if pd.api.types.is_datetime64_any_dtype(kind):
        return _moments_in(pd.DatetimeIndex(column), _given(unit))
    if pd.api.types.is_timedelta64_dtype(kind):
        return pd.TimedeltaIndex(column).total_seconds().to_numpy() / SECONDS[_given(unit)]
    if isinstance(kind, pd.PeriodDtype):
        return _moments_in(pd.PeriodIndex(column).to_timestamp(), _given(unit))
    if kind.kind == "O" and all(isinstance(entry, datetime.date) for entry in column):
        return _moments_in(pd.DatetimeIndex(pd.to_datetime(column)), _given(unit))
    texts = column.astype(object).where(column.notna(), "").tolist()
    if not all(isinstance(text, str) for text in texts):
        raise TimesError(
            f"has neither numbers nor dates that pandas knows, but {type(texts[0]).__name__}: "
            f"write times as numbers"
        )
    return _times_of([text.strip() for text in texts], unit)


def is_dated(values: Any) -> bool:
    """Whether times are dates or durations, and not numbers, as numbers or text."""
    import pandas as pd

    column = pd.Series(values)
    if pd.api.types.is_numeric_dtype(column.dtype):
        return False
    return not (isinstance(column.iloc[0], str) and is_number(column.iloc[0].strip()))


def _given(unit: str | None, what: str = "dates", row: int | None = None) -> str:
    if unit is None:
        raise TimesError(
            f"has {what}, but the time step has no unit: write it with one, such as "
            f"time_step: 5 minutes",
            row,
        )
    return unit


def _times_of(texts: Sequence[str], unit: str | None) -> FloatArray:
    """Times of a column of text: all are numbers, or dates, or dates with an offset from UTC."""
    import pandas as pd

    kinds = list(map(_kind, texts))
    row = next((row for row, kind in enumerate(kinds) if not kind or kind != kinds[0]), None)
    if row is not None:
        text = texts[row]
        if not text:
            raise TimesError("has no time; each row needs one", row)
        if kinds[row]:
            raise TimesError(f"has {text!r}, which is of another form than the rows before", row)
        raise TimesError(
            f"has {text!r}, which is neither a number nor a date in a form of ISO 8601 that is "
            f"read, such as 2010-03-24, 20100324T0951Z or 2010-03-24T09:51:00+01:00",
            row,
        )
    if kinds[0] == "number":
        return np.array(list(map(float, texts)))
    unit = _given(unit, f"the date {texts[0]!r}", 0)
    moments = pd.to_datetime(list(texts), format="ISO8601", utc=True, errors="coerce")
    if moments.hasnans:  # no such day or hour
        row = int(moments.isna().argmax())
        raise TimesError(f"has {texts[row]!r}, which is no date of the calendar", row)
    return _moments_in(moments, unit)


def _kind(text: str) -> str | None:
    if is_number(text):
        return "number"
    date = _DATE.fullmatch(text)
    return date and ("date with an offset" if date[1] else "date")


def _moments_in(moments: "pd.DatetimeIndex", unit: str) -> FloatArray:
    """Moments in units of time since 1970-01-01 UTC; without a zone, they count as UTC."""
    if moments.tz is not None:
        moments = moments.tz_convert("UTC")
    # whole microseconds: the quotient is rounded once
    values = moments.as_unit("us").asi8 / (SECONDS[unit] * 1_000_000)
    return np.where(moments.isna(), np.nan, values)


def with_units(time: Any, unit: str) -> Any:
    """A variable of xarray whose attributes say what its numbers mean, as dates or in a unit.

    What has no units is in the unit already. ``time``: Numbers, "hours since 2020-03-01" or "days".
    """
    import xarray  # takes half a second, and few campaigns need it

    units = str(time.attrs.get("units", "")).strip()
    if units in ("", "1"):
        return time
    word = units.partition(" since ")[0].lower()
    length = _SPELLINGS.get(word, _SPELLINGS.get(word.removesuffix("s")))
    if length is None or (" since " in units and not _SINCE.fullmatch(units)):
        raise TimesError(
            f"has the units {units!r}; with a unit in the time step, they must be seconds, "
            f"minutes, hours or days, of their own or since a date and a zone of ISO 8601"
        )
    if " since " not in units:
        return time * (length / SECONDS[unit])
    time = xarray.coders.CFDatetimeCoder(time_unit="us").decode(time)
    if time.dtype.kind != "M":
        raise TimesError(
            f"has dates of the calendar {time.encoding.get('calendar')}, or outside that of "
            f"pandas: write a time step without a unit, and times as numbers"
        )
    return time


def is_number(text: str) -> bool:
    """Whether a field is a number; in files, Python's 1_000 is not."""
    try:
        float("" if "_" in text or not text.isascii() else text)
    except ValueError:
        return False
    return True
