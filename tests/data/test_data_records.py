"""Records: regular times, gaps that cut, and every message."""

import re

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from burstcast.data.frames import from_dataframe, from_xarray
from burstcast.data.measured_data import Run
from burstcast.data.records import (
    check_regular,
    long_runs,
    problems_of_columns,
    recorded_series,
    runs_without_gaps,
)
from burstcast.data.times import time_step_of
from burstcast.systems.measured import MeasuredSeries

NAN = float("nan")
STEP = 5.0


def record(time, **columns):
    columns = {name: np.array(values, dtype=float) for name, values in columns.items()}
    return Run("a.csv", {"time": np.array(time, dtype=float), **columns})


def listed(runs, name="u"):
    return [run.columns[name].tolist() for run in runs]


def test_a_regular_record_stays_as_it_is():
    values = np.random.default_rng(1).normal(size=500)
    time = 1000.3 + 5 * np.arange(500)
    (run,) = runs_without_gaps(record(time, u=values), STEP)
    assert np.array_equal(run.columns["u"], values)
    np.testing.assert_allclose(run.columns["time"], time, rtol=1e-15)
    assert run.name == "a.csv, rows 1 to 500"


def test_missing_rows_and_empty_cells_cut():
    found = runs_without_gaps(
        record([0, 5, 10, 20, 25, 30, 35], u=[1, 2, 3, 4, 5, NAN, 7], v=[1] * 7), STEP
    )
    assert listed(found) == [[1, 2, 3], [4, 5], [7]]
    names = ["a.csv, rows 1 to 3", "a.csv, rows 4 to 5", "a.csv, rows 7 to 7"]
    assert [run.name for run in found] == names
    # the same of a column without times, where no row is missing
    assert listed(runs_without_gaps(Run("a.nc", {"u": np.array([1, 2, NAN, 4])}), STEP)) == [
        [1, 2],
        [4],
    ]


def test_times_off_the_grid_begin_another_run():
    # a sensor that was started again two minutes later, two rows at one place, a clock that drifts
    for time, expected in (
        ([0, 5, 12, 17], [[1, 2], [3, 4]]),
        ([0, 5.4, 9.6, 15.3], [[1, 2, 3, 4]]),
        ([0, 5, 5.2, 10], [[1, 2], [3, 4]]),
        (np.cumsum(np.full(7, 5.2)), [[1, 2, 3], [4, 5, 6], [7]]),
    ):
        assert listed(runs_without_gaps(record(time, u=np.arange(len(time)) + 1), STEP)) == expected
    drift = np.cumsum(np.full(2000, 5.002))
    lengths = [run.length for run in runs_without_gaps(record(drift, u=drift), STEP)]
    assert sum(lengths) == 2000
    assert set(lengths[:-1]) <= {250, 251}  # a tenth of a step


@given(
    steps=st.lists(st.sampled_from([1, 1, 1, 2, 3]), min_size=1, max_size=40),
    holes=st.sets(st.integers(0, 40)),
    jitter=st.lists(st.floats(-0.04, 0.04), min_size=41, max_size=41),
)
def test_against_brute_force(steps, holes, jitter):
    place = np.cumsum([0, *steps])
    values = np.where([row in holes for row in range(len(place))], NAN, 2.0 * place)
    time = STEP * (place + np.array(jitter[: len(place)]))
    found = runs_without_gaps(record(time, u=values), STEP)
    runs: list[list[float]] = []
    last = None
    for one, value in zip(place, values, strict=True):
        if np.isnan(value):
            continue
        if last is None or one - last > 1:
            runs.append([])
        runs[-1].append(value)
        last = one
    assert listed(found) == runs


@pytest.mark.parametrize(
    ("time", "values", "message"),
    [
        ([0, 5, 5], [1, 2, 3], r"a.csv, row 3: column 'time' stays at the time of row 2; times"),
        ([0, 60, 5], [1, 2, 3], r"row 3: column 'time' goes back by 55 from the time of row 2"),
        ([10, 5, 0], [1, 2, 3], r"a.csv: the record is in falling order, the newest row first"),
        ([0, NAN, 5], [1, 2, 3], r"a.csv, row 2: column 'time' has no time; each row needs one"),
        ([0, 5, 10], [1, np.inf, 3], r"a.csv, row 2: 'u' is infinite; write nan for gaps"),
    ],
)
def test_clocks_that_jump_are_refused(time, values, message):
    with pytest.raises(ValueError, match=message):
        runs_without_gaps(record(time, u=values), STEP)
    if np.isfinite(values).all():
        with pytest.raises(ValueError, match=message):
            check_regular(record(time, u=values), STEP)


def test_regular_times():
    time = 1e4 + 0.02 * np.arange(1000)
    check_regular(record(time), 0.02)
    check_regular(record([f"{value:.4f}" for value in time]), 0.02)
    check_regular(record(1.7e9 + 0.02 * np.arange(1000)), 0.02)  # seconds since 1970
    check_regular(record(time + 0.0015 * np.sin(np.arange(1000))), 0.02)
    with pytest.raises(ValueError, match=r"row 2: .* goes on by 0.02 .* step is 0.01, and the me"):
        check_regular(record(time), 0.01)
    with pytest.raises(ValueError, match=r"row 401: column 'time' goes on by 0\.04 from row 400"):
        check_regular(record(np.delete(time, 400 - 0)[:999]), 0.02)
    with pytest.raises(ValueError, match=r"mean step of the record 0.0201: cut records at their"):
        check_regular(record(np.arange(1000) * 0.0201), 0.02)  # it would drift by five rows


def test_short_parts_are_left_out_and_told():
    parts = runs_without_gaps(record([0, 5, 10, 20, 25], u=[1, 2, 3, 4, 5]), STEP)
    found, left_out = long_runs(parts, 3)
    assert listed(found) == [[1, 2, 3]]
    assert left_out == (
        "gaps leave 2 parts of the record; 1 of them, with 2 of 5 rows, are shorter than a block "
        "of 3 and left out; the first is a.csv, rows 4 to 5"
    )
    with pytest.raises(ValueError, match=r"as a block .* takes, 4: the longest of 2 has 3"):
        long_runs(parts, 4)
    with pytest.raises(ValueError, match="there are none"):
        long_runs([], 2)


@pytest.mark.parametrize(
    ("given", "step"),
    [(0.02, (0.02, None)), ("5 minutes", (5, "minute")), ("0.5 hours", (0.5, "hour"))],
)
def test_time_steps(given, step):
    assert time_step_of(given) == step


@pytest.mark.parametrize("given", ["5 months", "1 year", "day", "0 days", "-1 day", "1e3 seconds"])
def test_no_time_steps(given):
    with pytest.raises(ValueError, match="is no time step: write a number above 0, or one with"):
        time_step_of(given)


# -- from files and tables to series ---------------------------------------------------------------

DATA = {
    "components": ["u"],
    "known": ["twice = 2 * rain"],
    "observable": "u",
    "time_step": "1 day",
    "gaps": "cut",
    "blocks": {"duration": 4, "gap": 1},
}
SPACE = MeasuredSeries(("u",), "u")


def write(path, lost=(), **columns):
    days = pd.date_range("2020-01-01", periods=30, name="time").strftime("%Y-%m-%d")
    table = pd.DataFrame({"u": np.arange(30.0), "rain": np.arange(30) % 4.0} | columns, index=days)
    table.drop(index=days[list(lost)]).to_csv(path)
    return str(path)


def test_known_columns_are_cut_with_the_record(tmp_path):
    """Gaps of a known column cut the record; its values stay beside those of their rows."""
    rain = np.arange(30) % 4.0
    rain[11] = NAN
    path = write(tmp_path / "a.csv", rain=rain)
    found = recorded_series([path], DATA, SPACE)
    assert found.states[:, 0, 0].tolist() == [0, 5, 12, 17, 22]
    np.testing.assert_array_equal(found.known[..., 0], 2 * (found.states[..., 0] % 4))
    assert found.start.tolist() == [18262, 18267, 18274, 18279, 18284]  # days since 1970
    with pytest.raises(ValueError, match=r"column 'rain' has no number in row 12 of 30"):
        recorded_series([path], {**DATA, "gaps": None}, SPACE)


@pytest.mark.parametrize(
    ("columns", "lost", "changes", "message"),
    [
        ({}, [7], {"gaps": None}, r"a\.csv, row 8: column 'time' goes on by 2 from row 7"),
        ({}, [], {"time_step": "2 days"}, "no rows without a gap between them are as many as"),
        ({"u": np.full(30, 3.5)}, [], {}, "the component 'u' is 3.5 in all of the series of"),
        ({"u": [99, *np.arange(28) / 30, 99]}, [], {}, r"'u' has the value 99 in 2 rows.*\[99"),
        ({}, [], {"components": ["w"]}, r"a\.csv: there is no column 'w'; the columns are u, rain"),
    ],
)  # fmt: skip
def test_records_with_mistakes(tmp_path, columns, lost, changes, message):
    path = write(tmp_path / "a.csv", lost, **columns)
    with pytest.raises(ValueError, match=message):
        recorded_series([path], {**DATA, **changes}, SPACE)


def test_a_table_without_times(tmp_path):
    (tmp_path / "a.csv").write_text("date,u,rain\n2020-01-01,1,2\n")
    with pytest.raises(ValueError, match=r"a\.csv has no column 'time'; its columns are date, u,"):
        recorded_series([str(tmp_path / "a.csv")], DATA, SPACE)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"known": ["rhoo"]}, "known: there is no column 'rhoo' (did you mean 'rho'?)"),
        ({"known": ["x"]}, "known has x, which forecasters see and forecast as a component"),
        ({"known": ["mine = z"]}, "known has mine = z, which forecasters see"),
        ({"known": ["x = rho"]}, "known has x = rho, which forecasters see"),
        ({"known": ["r = rho", "r = 2 * rho"]}, "known has r twice"),
        ({"known": ["rho", "x + rho"]}, None),
    ],
)
def test_mistakes_in_known_columns(changes, message):
    data = {"components": ["x", "y"], "observable": "z", **changes}
    found = list(problems_of_columns(data, ["x", "y", "z", "rho"]))
    assert len(found) == (message is not None)
    assert message is None or found[0].startswith(message), found


def test_all_mistakes_are_told():
    data = {"components": ["x"], "observable": "z", "known": ["rhoo", "x", "rho", "rho", "sigma"]}
    found = list(problems_of_columns(data, ["x", "y", "z", "rho"]))
    assert [re.split(r" \(|,|;", one)[0] for one in found] == [
        "known: there is no column 'rhoo'",
        "known has x",
        "known has rho twice",
        "known: there is no column 'sigma'",
    ]


def test_a_table_of_pandas_is_what_its_file_is(tmp_path):
    path = write(tmp_path / "a.csv", lost=[10])
    table = pd.read_csv(path, parse_dates=["time"])
    for frame in (table, table.set_index("time"), table.convert_dtypes()):
        found = from_dataframe(frame, "1 day", ["u"], block=4, gap=1, cut_gaps=True)
        assert np.array_equal(found, recorded_series([path], DATA, SPACE).states)
    with pytest.raises(ValueError, match="the table, row 11: column 'time' goes on by 2"):
        from_dataframe(table, "1 day", ["u"])
    with pytest.raises(ValueError, match="the table has no column 'time'; its columns are u, rain"):
        from_dataframe(table[["u", "rain"]], "1 day")
    with pytest.raises(ValueError, match="'time' has dates, but the time step has no unit"):
        from_dataframe(table, 1, ["u"])
    with pytest.raises(ValueError, match="cut_gaps needs block"):
        from_dataframe(table, "1 day", ["u"], cut_gaps=True)


def test_arrays_of_xarray():
    xarray = pytest.importorskip("xarray")
    states = np.random.default_rng(0).normal(size=(2, 50, 3))
    time = 0.5 * np.arange(50)
    array = xarray.DataArray(states, dims=("series", "time", "component"), coords={"time": time})
    assert np.array_equal(from_xarray(array.transpose("time", "component", "series")), states)
    assert np.array_equal(from_xarray(array[1]), states[1:])
    assert np.array_equal(from_xarray(array.to_dataset("component")), states)
    with pytest.raises(ValueError, match="the record is in falling order"):
        from_xarray(array.isel(time=slice(None, None, -1)))
    with pytest.raises(ValueError, match="goes on by 1 from row 7"):
        from_xarray(array.drop_isel(time=7))
    with pytest.raises(ValueError, match=r"must have the dimensions series, time.*\.rename"):
        from_xarray(array.rename(component="rig"))
