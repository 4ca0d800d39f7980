"""Dates as numbers: by hand, against pandas, and every message."""

from zoneinfo import ZoneInfo

import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast.data.time_stamps import SECONDS, TimeStamps, duration_in


def test_by_hand():
    assert TimeStamps("day")("1971-01-01") == 365
    assert TimeStamps("hour")("1970-01-02T01:30") == 25.5
    assert TimeStamps("minute")("1970-01-01 00:01:30.5") == pytest.approx(1.5 + 0.5 / 60, rel=1e-15)
    assert TimeStamps("second")("1970-01-01T01:00:00+01:00") == 0
    assert TimeStamps("second")("1969-12-31T23:59Z") == -60
    assert TimeStamps("minute")("12.5") == 12.5  # a number has the unit already


@given(
    moment=st.datetimes(),
    unit=st.sampled_from(sorted(SECONDS)),
    zone=st.sampled_from(["UTC", "Europe/Berlin", "America/New_York", "Asia/Kolkata"]),
)
def test_dates_are_those_of_pandas(moment, unit, zone):
    year = moment.replace(year=1980 + moment.year % 60, day=min(moment.day, 28), microsecond=0)
    try:
        there = pd.Timestamp(year).tz_localize(zone, ambiguous="raise", nonexistent="raise")
    except ValueError:
        with pytest.raises(ValueError, match=r"the clocks of .* (skip|show twice): write times in"):
            TimeStamps(unit, zone)(year.isoformat())
        return
    expected = there.timestamp() / SECONDS[unit]
    assert TimeStamps(unit, zone)(year.isoformat()) == pytest.approx(expected, rel=1e-14)
    offset = year.replace(tzinfo=ZoneInfo(zone)).isoformat()
    if len(offset) == 25:  # offsets of whole minutes, which ISO 8601 has
        assert TimeStamps(unit)(offset) == pytest.approx(expected, rel=1e-14)


def test_the_hours_that_clocks_skip_and_repeat():
    read = TimeStamps("hour", "Europe/Berlin")
    assert read("2010-03-28 03:00") - read("2010-03-28 01:55") == pytest.approx(5 / 60)
    with pytest.raises(ValueError, match=r"'2010-03-28 02:30', which the clocks of .* skip"):
        read("2010-03-28 02:30")
    with pytest.raises(ValueError, match=r"'2010-10-31 02:30', which the clocks .* show twice"):
        read("2010-10-31 02:30")


@pytest.mark.parametrize(
    ("stamps", "zone", "message"),
    [
        ([""], None, "has no time"),
        (["24.03.2010"], None, "neither a number nor a date as ISO 8601 writes it"),
        (["2010-3-24"], None, "neither a number nor a date"),
        (["20100324T0951"], None, "neither a number nor a date"),
        (["2010-02-30"], None, "'2010-02-30': day"),
        (["1_000"], None, "neither a number nor a date"),
        (["2010-01-01", "5"], None, "is a number; the rows before have a date without an offset"),
        (["2010-01-01T00:00", "2010-01-01T00:00Z"], None, "which is a date with an offset; the"),
        (["2010-01-01T00:00Z"], "Europe/Berlin", "data.time_zone is Europe/Berlin: leave it out"),
    ],
)
def test_what_is_no_time(stamps, zone, message):
    read = TimeStamps("day", zone)
    for stamp in stamps[:-1]:
        read(stamp)
    with pytest.raises(ValueError, match=message):
        read(stamps[-1])


def test_durations():
    assert duration_in("1 day", "minute") == 1440
    assert duration_in("12hours", "day") == 0.5
    assert duration_in("1 year", "day") == 365.2425
    assert duration_in(3, None) == 3
    with pytest.raises(ValueError, match="is no duration"):
        duration_in("1 fortnight", "day")
    with pytest.raises(ValueError, match="is no duration"):
        duration_in("0 days", "day")
    with pytest.raises(ValueError, match=r"takes a unit of time: say it \(data.time_unit\)"):
        duration_in("1 day", None)
