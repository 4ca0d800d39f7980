"""Records and measured columns: what is taken, regular times, gaps that cut, and every message."""

import math
import re
import warnings
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import scipy.io
import xarray
from hypothesis import given
from hypothesis import strategies as st

from burstcast.data.measured_data import (
    Blocks,
    Quantity,
    Run,
    check_varying,
    code_of_gaps,
    kept_series,
    series_of_runs,
)
from burstcast.data.records import (
    check_regular,
    long_runs,
    measured_series,
    problems_of_columns,
    recorded_series,
    runs_without_gaps,
)
from burstcast.data.series_files import content_of
from burstcast.data.times import time_step_of
from burstcast.systems.measured import MeasuredSeries

NAN = float("nan")
STEP = 5.0


def record(time, **columns):
    columns = {name: np.array(values, dtype=float) for name, values in columns.items()}
    return Run("a.csv", {"time": np.array(time, dtype=float), **columns})


def listed(runs, name="u"):
    return [run.columns[name].tolist() for run in runs]


def test_times_off_the_grid_begin_another_run():
    for time, expected in (
        ([0, 5, 12, 17], [[1, 2], [3, 4]]),  # a sensor that was started again two minutes later
        ([0, 5.4, 9.6, 15.3], [[1, 2, 3, 4]]),
        ([0, 5, 5.2, 10], [[1, 2], [3, 4]]),  # two rows at one place
        (np.cumsum(np.full(7, 5.2)), [[1, 2, 3], [4, 5, 6], [7]]),  # a clock that drifts
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
    parts = runs_without_gaps(record(time, u=values), STEP)
    rows = [row for row in range(len(place)) if row not in holes]
    apart = [n for n in range(1, len(rows)) if place[rows[n]] - place[rows[n - 1]] > 1]
    expected = [part for part in np.split(rows, apart) if len(part)]
    assert listed(parts) == [values[part.astype(int)].tolist() for part in expected]
    names = [f"a.csv, rows {part[0] + 1:.0f} to {part[-1] + 1:.0f}" for part in expected]
    assert [part.name for part in parts] == names
    # the same of a column without times, where no row is missing
    run = Run("a.nc", {"u": np.array([1, 2, NAN, 4])})
    assert listed(runs_without_gaps(run, STEP)) == [[1, 2], [4]]


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
    rounded, since_1970 = [f"{value:.4f}" for value in time], 1.7e9 + 0.02 * np.arange(1000)
    for times in (time, rounded, since_1970, time + 0.0015 * np.sin(np.arange(1000))):
        check_regular(record(times), 0.02)
    for times, step, message in (
        (time, 0.01, r"row 2: .* goes on by 0.02 .* step is 0.01, and the me"),
        (np.delete(time, 400), 0.02, r"row 401: column 'time' goes on by 0\.04 from row 400"),
        # it would drift by five rows
        (np.arange(1000) * 0.0201, 0.02, r"it has no gap; write data.time_step: 0.0201"),
    ):
        with pytest.raises(ValueError, match=message):
            check_regular(record(times), step)


def test_short_parts_are_left_out():
    parts = runs_without_gaps(record([0, 5, 10, 20, 25], u=[1, 2, 3, 4, 5]), STEP)
    assert listed(long_runs(parts, 3)) == [[1, 2, 3]]
    with pytest.raises(ValueError, match=r"as a series takes, 4 .*: the longest of 2 has 3"):
        long_runs(parts, 4)
    with pytest.raises(ValueError, match="there are none"):
        long_runs([], 2)


def test_time_step_of_a_number_or_one_with_a_unit():
    for written, step in ((0.02, (0.02, None)), ("5 minutes", (5, "minute"))):
        assert time_step_of(written) == step
    assert time_step_of("0.5 hours") == (0.5, "hour")
    for written in ("5 months", "1 year", "day", "0 days", "-1 day", "1e3 seconds"):
        with pytest.raises(ValueError, match="is no time step: write a number above 0, or one wit"):
            time_step_of(written)


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


RAIN = np.where(np.arange(30) == 11, NAN, np.arange(30) % 4.0)


@pytest.mark.parametrize(
    ("blocks", "lengths", "starts", "messages"),
    [
        (
            *((None, 0, 3), [7, 18], [4, 12]),
            ["gaps leave 3 parts of the record; 1 of them, with 3 of 28 rows,", "2 series have 7"],
        ),
        ((7, 1, 1), [3, 7, 8, 8, 2], [0, 4, 12, 20, 28], ["5 series have 2 to 8 samples"]),
        ((7, 3, 3), [7, 8, 8], [4, 12, 22], ["gaps leave", "3 series have 7 to 8 samples"]),
        (
            *((4, 1, None), [5] * 4, [4, 12, 17, 22]),
            ["gaps leave", "5 of 25 rows, at the ends of 2 of 2 runs, are too few for a series"],
        ),
    ],
)
def test_series_of_runs_and_of_blocks(tmp_path, blocks, lengths, starts, messages):
    """Whole runs between gaps, or blocks and what is left of a run; all rows are accounted for.

    Gaps of a known column cut the record, too; its values stay beside those of their rows.
    """
    path = write(tmp_path / "a.csv", lost=[3], rain=RAIN)  # runs of 3, 7 and 18 days
    blocks = dict(zip(("duration", "gap", "shortest"), blocks, strict=True))
    recorded = recorded_series([path], {**DATA, "blocks": blocks}, SPACE)
    assert (~np.isnan(recorded.states[..., 0])).sum(axis=1).tolist() == lengths
    assert recorded.start.tolist() == [18262 + start for start in starts]
    for row, (first, length) in enumerate(zip(starts, lengths, strict=True)):
        values = recorded.states[row, :length, 0]
        np.testing.assert_array_equal(values, np.arange(first, first + length))
        np.testing.assert_array_equal(recorded.covariates[row, :length, 0], 2 * (values % 4))
    for message, beginning in zip(recorded.messages, messages, strict=True):
        assert message.startswith(beginning)
    if blocks["duration"] is None:
        cut = measured_series(path, "1 day", ["u", "rain"], shortest=3, cut_gaps=True)
        assert [series[:, 0].tolist() for series in cut] == [[*range(4, 11)], [*range(12, 30)]]


@pytest.mark.parametrize("lengths", [{"block": 0.0}, {"shortest": 0.0}, {"block": 4, "gap": -1.0}])
def test_lengths_of_blocks_are_above_0(lengths):
    with pytest.raises(ValueError, match="must be above 0, and gap not below it"):
        measured_series(np.sin(np.arange(40.0))[:, np.newaxis], 1.0, **lengths)


def test_a_time_step_that_drifts_off_the_times_is_told():
    """A step of 1 where it is 1.004 cuts 14 times without a gap, and once at the gap."""
    rows = np.arange(400)
    time = 1.004 * rows + 5 * (rows >= 200)
    table = pd.DataFrame({"time": time, "u": np.sin(rows)})
    told = r"14 of 16 parts begin without a gap, .* time step, 1. The mean step is 1\.004:"
    with pytest.warns(UserWarning, match=told):
        assert len(measured_series(table, 1.0, shortest=3, cut_gaps=True)) == 16
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cut = measured_series(table, 1.004, shortest=3, cut_gaps=True)
    assert np.array_equal(cut[:, :, 0], np.sin(rows).reshape(2, 200))
    # where rows have times, those of the first sample of each series
    data = {"time_step": 1.004, "components": ["u"], "known": (), "gaps": "cut", "blocks": None}
    assert recorded_series([table], data, MeasuredSeries(["u"], "u")).start.tolist() == [
        *(0.0, 200 * 1.004 + 5),
    ]


def test_an_array_of_several_series_may_end_with_nan():
    states = np.arange(24.0).reshape(2, 6, 2)
    states[1, 4:] = NAN
    array = xarray.DataArray(states, dims=("series", "time", "component"), name="state")
    cut = measured_series(array, 1)
    assert [series.tolist() for series in cut] == [states[0].tolist(), states[1, :4].tolist()]
    for row, place in ((1, 3), (0, 5)):  # within a series, or in one component
        damaged = array.copy()
        damaged[row, place, 0] = NAN
        with pytest.raises(ValueError, match=f"series {row + 1}: column 'c1' has no number in row"):
            measured_series(damaged, 1)


@pytest.mark.parametrize(
    ("columns", "lost", "changes", "message"),
    [
        ({}, [7], {"gaps": None}, r"a\.csv, row 8: column 'time' goes on by 2 from row 7"),
        ({"rain": RAIN}, [], {"gaps": None}, "column 'rain' has no number in row 12 of 30"),
        ({}, [], {"time_step": "2 days"}, "no two rows are the time step"),
        ({}, [], {"blocks": {"duration": 40, "gap": 0}}, "no rows without a gap between them"),
        ({"u": np.full(30, 3.5)}, [], {}, "the component 'u' is 3.5 in all of the series of"),
        ({"u": [99, *np.arange(28) / 30, 99]}, [], {}, r"'u' has the value 99 in 2 rows.*\[99"),
        ({}, [], {"components": ["w"]}, r"a\.csv: there is no column 'w'; the columns are u, rain"),
    ],
)  # fmt: skip
def test_records_with_mistakes(tmp_path, columns, lost, changes, message):
    path = write(tmp_path / "a.csv", lost, **columns)
    with pytest.raises(ValueError, match=message):
        recorded_series([path], {**DATA, **changes}, SPACE)


@pytest.mark.parametrize(
    ("known", "messages"),
    [
        (["mine = z"], ["known has mine = z, which forecasters see and forecast as a component"]),
        (["x = rho"], ["known has x = rho, which forecasters see"]),
        (["r = rho", "r = 2 * rho"], ["known has r twice"]),
        (["rho", "x + rho"], []),
        (
            ["rhoo", "x", "rho", "rho", "sigma"],  # all mistakes are told
            [
                "known: there is no column 'rhoo' (did you mean 'rho'?)",
                "known has x, which",
                "known has rho twice",
                "known: there is no column 'sigma'",
            ],
        ),
    ],
)
def test_mistakes_in_known_columns(known, messages):
    data = {"components": ["x", "y"], "observable": "z", "known": known}
    problems = list(problems_of_columns(data, ["x", "y", "z", "rho"]))
    assert len(problems) == len(messages)
    for problem, message in zip(problems, messages, strict=True):
        assert problem.startswith(message)


def test_tables_and_arrays_are_what_their_files_are(tmp_path):
    path = write(tmp_path / "a.csv", lost=[10])
    expected = recorded_series([path], DATA, SPACE).states
    table = pd.read_csv(path, parse_dates=["time"])
    array = table.set_index("time").to_xarray()
    array.to_netcdf(tmp_path / "a.nc")
    sources = (path, tmp_path / "a.nc", table, table.set_index("time"), pd.read_csv(path), array)
    for source in (*sources, array.to_dataarray("component"), table.convert_dtypes()):
        cut = measured_series(source, "1 day", ["u"], block=4, gap=1, cut_gaps=True)
        assert np.array_equal(cut, expected)
        with pytest.raises(ValueError, match="row 11: column 'time' goes on by 2"):
            measured_series(source, "1 day", ["u"])
    both = measured_series([table, array], "1 day", ["u"], block=4, cut_gaps=True)
    assert np.array_equal(both, np.concatenate([expected, expected]))
    empty = {"components": ["u", "w"], "block": 4, "cut_gaps": True}
    for error, message, arguments in (
        (
            ValueError,
            "the table: there is no column 'x'; the columns are u, r",
            {"components": ["x"]},
        ),
        (ValueError, r"cut_gaps needs block.* or shortest", {"cut_gaps": True}),
        (TypeError, r"components must be a list: \['u'\]", {"components": "u"}),
        (TypeError, "block must be a number, in time units .* not '4 days'", {"block": "4 days"}),
        (ValueError, "block and shortest must be above 0", {"block": -5}),
        (TypeError, "shortest must be a number", {"shortest": "4 days"}),
        (ValueError, "the time step must be finite and above 0, not nan", {"time_step": math.nan}),
        (ValueError, "column 'w' has no number at all: leave it out", empty),
    ):
        with pytest.raises(error, match=message):
            measured_series(
                table.assign(w=NAN), **{"time_step": "1 day", "components": ["u"], **arguments}
            )


# -- from columns to series ------------------------------------------------------------------------

GENERATOR = np.random.default_rng(1)


def run(name="run_1.csv", length=20, **columns):
    given = {key: GENERATOR.normal(size=length) for key in ("u", "v", "flow rate [l/s]")}
    return Run(name, {**given, **columns})


def series(runs, components, observable, blocks=None):
    quantities = [Quantity(text) for text in components]
    space = MeasuredSeries([quantity.name for quantity in quantities], observable)
    return series_of_runs(runs, space, quantities, blocks)


def test_columns_expressions_and_an_observable_that_is_none_of_the_components():
    runs = [run("a"), run("b")]
    selected = series(runs, ["v", "u2 = u**2", "q = flow rate [l/s]", "u - v"], "v")
    for states, source in zip(selected, runs, strict=True):
        u, v, q = source.columns.values()
        np.testing.assert_array_equal(states, np.stack([v, u * u, q, u - v], axis=1))
    source = run()
    selected = series([source], ["u"], "u * v")
    np.testing.assert_array_equal(selected[0, :, 1], source.columns["u"] * source.columns["v"])
    # an expression of components is none of its own
    assert series([source], ["u", "v"], "u * v").shape == (1, 20, 2)
    assert series([run(v=np.full(20, np.nan))], ["u"], "u").shape == (1, 20, 1)


@given(length=st.integers(5, 200), samples=st.integers(2, 60), gap=st.integers(1, 30))
def test_blocks_lie_end_to_end_with_gaps(length, samples, gap):
    record = Run("a", {"u": np.arange(length) + 1.0})
    if length < samples:
        with pytest.raises(ValueError, match=f"a has {length} rows, but a block .* {samples}"):
            series([record], ["u"], "u", Blocks(samples, gap, samples))
        return
    cut = series([record], ["u"], "u", Blocks(samples, gap, samples))[:, :, 0]
    # brute force: row by row
    rows, expected = list(range(1, length + 1)), []
    while len(rows) >= samples:
        expected.append(rows[:samples])
        rows = rows[samples - 1 + gap :]
    assert cut.tolist() == expected
    assert len(set(cut.flat)) == cut.size  # no sample twice


def test_blocks_of_a_duration():
    assert Blocks.of(10.0, 2.0, None, 0.5) == Blocks(21, 4, 21)
    assert Blocks.of(0.3, 0.0, 0.2, 0.1) == Blocks(4, 1, 3)
    assert Blocks.of(None, 0.25, 1.0, 0.1) == Blocks(None, 3, 11)  # at least the gap


@pytest.mark.parametrize(
    ("columns", "components", "observable", "message"),
    [
        ({}, ["w"], "u", "run_1.csv: there is no column 'w'.*the columns are u, v, flow rate"),
        ({}, ["u", "vv"], "u", "no column 'vv' .did you mean 'v'"),
        ({}, ["u"], "u + w", "run_1.csv: there is no column 'w'"),
        ({}, ["u", "w = a b"], "u", "no column 'a b', and 'a b' is no arithmetic expression$"),
        (
            {},
            ["u", "w = log(flow rate [l/s])"],
            "u",
            r"'flow rate \[l/s\]' can stand alone.*: rename the column",
        ),
        (
            {"u": np.array([0.0, 1, np.nan, 2, np.nan])},
            ["u"],
            "u",
            r"run_1.csv: column 'u' has no number in row 3 of 5 \(2 such rows in all\)",
        ),
        ({"u": np.array([0.0, 1, -np.inf])}, ["u"], "u", "'u' is infinite in row 3 of 3: fill"),
        (
            {"u": np.array([1.0, -1, 2])},
            ["r = sqrt(u)"],
            "r",
            "run_1.csv: the component 'r' has no number in row 2 of 3",
        ),
    ],
)
def test_mistakes(columns, components, observable, message):
    length = len(next(iter(columns.values()), np.empty(20)))
    with pytest.raises(ValueError, match=message):
        series([run(length=length, **columns)], components, observable)


@pytest.mark.parametrize(
    ("values", "error", "message"),
    [
        (np.ma.masked_greater(np.arange(20.0), 17), ValueError, r"\[18\] is \(2 in all\)"),
        (np.full(20, 9.969209968386869e36), ValueError, "has no number in row 1 of 20"),
        (np.arange(20) * 1j, TypeError, "real numbers, not of complex128"),
        (np.arange(20).astype(str), TypeError, "real numbers, not of <U2"),
    ],
)
def test_columns_without_real_numbers(values, error, message):
    with pytest.raises(error, match=rf"run_1\.csv: column 'u' .*{message}"):
        series([run(u=values)], ["u"], "u")


def test_micro_signs():
    """Python takes the sign and the Greek letter for one name; files do not."""
    micro, greek = "\N{MICRO SIGN}", "\N{GREEK SMALL LETTER MU}"
    both = run(**{greek: np.arange(20.0)}, **{micro: np.arange(1.0, 21)})
    assert np.array_equal(series([both], [f"2 * {micro}"], micro)[0, :, 0], np.arange(2.0, 42, 2))
    assert MeasuredSeries([micro], f"2 * {micro}").dimension == 1
    alike = r"run_1\.csv: there is no column .* is written with other characters: copy it"
    for text in (greek, f"2 * {greek}"):
        with pytest.raises(ValueError, match=alike):
            series([run(**{micro: np.arange(20.0)})], [text], text)


def test_components_that_are_constant_in_each_series_and_not_in_all_vary():
    check_varying(np.stack([np.zeros((5, 2)), np.ones((5, 2))]), ["u", "v"], "the series")


@pytest.mark.parametrize(
    ("code", "times", "is_code"),
    [
        (99.0, 20, True),
        (-999.99, 2, True),
        (9999, 3, True),
        (99.0, 1, False),  # it does not repeat
        (98.0, 20, False),  # it is not written as codes are
        (9.0, 20, False),  # nor far away
        (0.0, 200, False),  # a rain gauge
    ],
)
def test_codes_for_missing_numbers(code, times, is_code):
    values = np.append(1.5 + 0.8 * np.sin(np.arange(500) / 40), np.full(times, code))
    assert code_of_gaps(values) == (code if is_code else None)
    for few in (np.array([0.0, 99, 0, 99]), np.full(3, np.nan)):  # two states of a switch
        assert code_of_gaps(few) is None


def test_series_beyond_the_laminarisation_threshold():
    observable = np.array([[-3.0, -2, -3], [-3, -3, -3], [0, -3, 0]])
    index, lifetimes = kept_series(observable, -2.5)
    assert index.tolist() == [1]
    assert lifetimes.tolist() == [1, 2, 0]
    index, lifetimes = kept_series(observable, None)
    assert (index.tolist(), lifetimes.tolist()) == ([0, 1, 2], [2, 2, 2])
    with pytest.raises(ValueError, match="all 3 series exceed laminarisation_threshold, -4"):
        kept_series(observable, -4)


# -- docs/data_recipes.md as it is written ---------------------------------------------------------

PAGE = Path(__file__).parents[2] / "docs" / "data_recipes.md"
RECIPES = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
HOURS = pd.date_range("2021-03-27", periods=48, freq="h", tz="UTC")


def recipe(beginning):
    """The only recipe whose first line begins so."""
    (matching,) = [text for text in RECIPES if text.startswith(f"# {beginning}")]
    return matching


def berlin(path):
    local = HOURS.tz_convert("Europe/Berlin").tz_localize(None)
    pd.DataFrame({"time": local, "u": range(48)}).to_csv(path / "raw.csv", index=False)


def daily(path):
    days = pd.date_range("2010-01-01", periods=1500)
    angle = 2 * np.pi * np.arange(1500) / 365.2425
    heat = 3 + 2 * np.cos(angle) + np.where(np.arange(1500) < 1000, 0.0, 5.0)
    pd.DataFrame({"time": days, "heat": heat}).to_csv(path / "raw.csv", index=False)


def gaps(path):
    values = np.arange(20.0)
    values[[3, 8, 9, 10, 11, 15, 16, 17]] = np.nan
    pd.DataFrame({"time": range(20), "u": values}).to_csv(path / "raw.csv", index=False)


def buoy(path):
    rows = [f"2019 08 01 {hour:02d} {99 if hour == 3 else 1.5:5.2f}" for hour in range(6)]
    (path / "raw.txt").write_text("\n".join(["YY MM DD hh WVHT", *rows]))


def text(name, content):
    return lambda path: (path / name).write_text(content, encoding="utf-8")


def parts(path):
    (path / "raw_1.csv").write_text("time,u\n0,1\n1,2\n")
    (path / "raw_2.csv").write_text("time,u\n2,3\n")


TWO = {"u": [1, 3], "v": [2, 4]}
MINUTES = "time,u\n2020-01-01T00:00,1\n2020-01-01T00:06,2\n2020-01-01T00:15,4\n"
NEWEST = ",u\n2009-08-02,1\n2009-08-01,2\n"
LABELLED = "run,time,u\nb,0,1\nb,1,2\na,0,3\na,1,4\n"
MATLAB, NUMPY = {"data": [[1, 2], [3, 4]], "t": [0, 1]}, [[[1.0, 2], [3, 4]]]
CASES = [
    ("raw.csv: Zeit", text("raw.csv", "Zeit;Höhe\n0;1,5\n1;2\n"), "lab.csv", 1, {"Höhe": [1.5, 2]}),
    ("raw.dat:", text("raw.dat", "# u v\n1 2\n3 4\n"), "lab.csv", 0.02, TWO),
    ("raw.txt: YY", buoy, "lab.csv", "1 hour", {"WVHT": [1.5, 1.5, 1.5, NAN, 1.5, 1.5]}),
    (
        "raw.csv: month",
        text("raw.csv", "month,u\n1749-12,1\n1750-01,2\n"),
        "lab.csv",
        1,
        {"u": [1, 2]},
    ),
    ("raw.csv: the first", text("raw.csv", NEWEST), "lab.csv", "1 day", {"u": [2, 1]}),
    ("raw.csv: times of a clock", berlin, "lab.csv", "1 hour", {"u": range(48)}),
    ("raw.csv: every 5", text("raw.csv", MINUTES), "lab.csv", "5 minutes", {"u": [1, 2, 3, 4]}),
    ("raw.csv: gaps", gaps, "lab.csv", 1, {"u": [*range(8), *[NAN] * 4, *range(12, 20)]}),
    ("raw_1.csv", parts, "lab.csv", 1, {"u": [1, 2, 3]}),
    ("raw.csv: a column run", text("raw.csv", LABELLED), "run_a.csv", 1, {"u": [3, 4]}),
    ("raw.csv: daily", daily, "lab.csv", "1 day", {"heat": [*[0] * 1000, *[5] * 500]}),
    ("raw.mat", lambda path: scipy.io.savemat(path / "raw.mat", MATLAB), "lab.csv", 1, TWO),
    ("raw.npy: many", lambda path: np.save(path / "raw.npy", NUMPY), "lab.nc", 0.02, TWO),
]


@pytest.mark.parametrize(("beginning", "prepare", "file", "step", "expected"), CASES)
def test_a_recipe(tmp_path, monkeypatch, beginning, prepare, file, step, expected):
    monkeypatch.chdir(tmp_path)
    prepare(tmp_path)
    exec(recipe(beginning), {})
    (run,) = content_of(file).read(list(expected), time_step_of(step)[1])
    check_regular(run, time_step_of(step)[0])
    for name, values in expected.items():
        np.testing.assert_allclose(run.columns[name], list(values), atol=1e-9)


def test_in_a_notebook(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    table = pd.DataFrame({"time": HOURS, "u": np.arange(48.0), "v": np.arange(48.0) ** 2})
    table.drop(index=22).to_csv("raw.csv", index=False)
    names = {}
    exec(recipe("raw.csv: hourly"), names)
    np.testing.assert_array_equal(names["series"][:, :, 0], [np.arange(23, 48)])


def test_every_recipe_is_run():
    assert len(RECIPES) == len(CASES) + 1


@pytest.mark.parametrize("missing", [[], [2], [3], [2, 3], [25]])
def test_a_local_clock_in_autumn_with_hours_that_the_record_lacks(missing, tmp_path, monkeypatch):
    hours = pd.date_range("2021-10-30T22:00", periods=30, freq="h", tz="UTC")
    there = np.setdiff1d(np.arange(30), missing)  # 2 and 3 are both shown as two o'clock
    local = hours.tz_convert("Europe/Berlin").tz_localize(None)
    table = pd.DataFrame({"time": local, "u": range(30)}).iloc[there]
    table.to_csv(tmp_path / "raw.csv", index=False)
    monkeypatch.chdir(tmp_path)
    exec(recipe("raw.csv: times of a clock"), {})
    written = pd.read_csv("lab.csv", parse_dates=["time"])
    assert (hours[written["u"]] == written["time"]).all()
    lost = {2, 3} if len({2, 3} & set(missing)) == 1 else set()
    assert set(there) - set(written["u"]) <= lost
