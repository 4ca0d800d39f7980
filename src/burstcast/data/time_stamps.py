"""Time stamps with dates (ISO 8601) as numbers of time units since 1970-01-01T00:00 UTC."""

import re
from datetime import UTC, datetime, timedelta
from typing import Literal
from zoneinfo import ZoneInfo

SECONDS = {"second": 1, "minute": 60, "hour": 3600, "day": 86400}
"""Units of time that a record with dates may have, all of constant length, in seconds."""

YEAR = 365.2425
"""Days of a year in the Gregorian calendar, on average."""

_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
_STAMP = re.compile(
    r"\d{4}-\d\d-\d\d([T ]\d\d:\d\d(:\d\d([.,]\d+)?)?(Z|[+-]\d\d(:?\d\d)?)?)?", re.ASCII
)
_DURATION = re.compile(r"(\d+(?:\.\d+)?) ?(second|minute|hour|day|year)s?", re.ASCII)


def duration_in(duration: float | str, unit: str | None) -> float:
    """Return a duration in a unit of time.

    ``duration``: A number of time units, or text: ``1 day``, ``90 minutes``, ``1 year`` (365.2425
    days).

    Examples
    --------
    >>> duration_in("1 day", "minute")
    1440.0
    """
    if not isinstance(duration, str):
        return float(duration)
    found = _DURATION.fullmatch(duration)
    if found is None or not float(found[1]):
        raise ValueError(
            f"{duration!r} is no duration: write a number above 0 and second, minute, hour, day or "
            f"year, such as 1 day"
        )
    if unit is None:
        raise ValueError(f"{duration!r} takes a unit of time: say it (data.time_unit)")
    seconds = YEAR * SECONDS["day"] if found[2] == "year" else SECONDS[found[2]]
    return float(found[1]) * seconds / SECONDS[unit]


class TimeStamps:
    """Reader of the column of times of a table, row by row.

    A column has either numbers, or dates, or dates with offsets from UTC, in all of its rows.

    ``unit``: Unit of the times that it returns, one of `SECONDS`. Numbers have it already.
    ``zone``: Time zone of dates without an offset: "Europe/Berlin". Without one, such dates come
    from a clock that is never put forward or back, and count as UTC.

    Examples
    --------
    >>> read = TimeStamps("hour", "Europe/Berlin")
    >>> read("1970-01-02 01:30") - read("1970-01-01 01:00")
    24.5
    """

    def __init__(self, unit: str, zone: str | None = None) -> None:
        self.unit = unit
        self.zone = ZoneInfo(zone) if zone else None
        self.kind = ""

    def __call__(self, text: str) -> float:
        """Time of a stamp."""
        text = text.strip()
        found: float | datetime
        try:
            found = float("" if "_" in text else text)
        except ValueError:
            found = self._moment(text)
        if isinstance(found, float):
            kind = "a number"
        else:
            kind = "a date without an offset" if found.tzinfo is None else "a date with an offset"
        if self.kind and kind != self.kind:
            raise ValueError(f"has {text!r}, which is {kind}; the rows before have {self.kind}")
        self.kind = kind
        if isinstance(found, float):
            return found
        since = self._universal(text, found) - _EPOCH
        # whole microseconds: the quotient is rounded once
        return since // timedelta(microseconds=1) / (SECONDS[self.unit] * 1_000_000)

    def _moment(self, text: str) -> datetime:
        if not text:
            raise ValueError("has no time")
        try:
            if _STAMP.fullmatch(text):
                return datetime.fromisoformat(text)
        except ValueError as error:
            raise ValueError(f"has {text!r}: {error}") from None
        raise ValueError(
            f"has {text!r}, which is neither a number nor a date as ISO 8601 writes it, such as "
            f"2010-03-24, 2010-03-24T09:51 or 2010-03-24T09:51:00+01:00"
        )

    def _universal(self, text: str, moment: datetime) -> datetime:
        if moment.tzinfo is not None:
            if self.zone is not None:
                raise ValueError(
                    f"has {text!r} with an offset from UTC, but data.time_zone is {self.zone}: "
                    f"leave it out"
                )
            return moment.astimezone(UTC)
        if self.zone is None:
            return moment.replace(tzinfo=UTC)
        fate = hour_of_change(moment, self.zone)
        if fate is not None:
            raise ValueError(
                f"has {text!r}, which the clocks of {self.zone} {fate}: write times in UTC, or "
                f"with their offsets from it"
            )
        return moment.replace(tzinfo=self.zone).astimezone(UTC)


def hour_of_change(moment: datetime, zone: ZoneInfo) -> Literal["skip", "show twice"] | None:
    """Whether a time without an offset is skipped or repeated by the zone; None: neither."""
    first, second = (moment.replace(tzinfo=zone, fold=fold) for fold in (0, 1))
    if first.utcoffset() == second.utcoffset():
        return None
    back = first.astimezone(UTC).astimezone(zone).replace(tzinfo=None)
    return "show twice" if back == moment else "skip"
