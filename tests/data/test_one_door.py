"""Series of a user through both doors, `EventForecaster` and `measured_series`.

Whatever container, index, labels and clock a series has: it is the plain array, or it is refused.
"""

import datetime
import itertools
import unicodedata

import numpy as np
import pandas as pd
import pytest
import xarray

import burstcast
from burstcast.data.clocks import irregularity
from burstcast.data.named_arrays import NamedArrays
from burstcast.data.no_state import columns_of_no_state
from burstcast.data.records import measured_series
from burstcast.data.series_layout import labelled_series, observation_of

RUNS = np.random.default_rng(3).normal(size=(3, 40, 2)).round(3)  # (series, time, component)
STEP = 0.25  # seconds
SECONDS = STEP * np.arange(40)
DATES = pd.Timestamp("2020-01-01") + pd.to_timedelta(SECONDS, unit="s")


class OtherFrame:
    """A frame of another library: names of columns, and columns that NumPy reads."""

    def __init__(self, columns):
        self._columns = columns

    @property
    def columns(self):
        return list(self._columns)

    def __getitem__(self, name):
        return self._columns[name]

    def __len__(self):
        return len(next(iter(self._columns.values())))


def frames_of(library):
    def convert(tables):
        package = pytest.importorskip(library)
        if library == "polars":
            return [package.DataFrame({str(c): t[c].to_numpy() for c in t}) for t in tables]
        return [package.table({str(c): t[c].to_numpy() for c in t}) for t in tables]

    return convert


class LazyFrame:
    """A frame of partitions that is computed when it is asked for, with an index, as of Dask."""

    def __init__(self, table):
        self._parts = [table.iloc[:20], table.iloc[20:]]
        self.npartitions, self.ndim, self.columns = 2, 2, table.columns
        self.iloc, self.index = None, None

    def compute(self):
        return pd.concat(self._parts)

    def __getitem__(self, name):
        raise NotImplementedError


def grouped(tables):
    return pd.concat([t.assign(run=n) for n, t in enumerate(tables)]).groupby("run")


def to_xarray(table):
    return table.rename_axis("time").to_xarray()


CONTAINERS = {
    "list": list,
    "tuple": tuple,
    "generator": lambda tables: (table for table in tables),
    "dictionary": lambda tables: dict(zip("abc", tables, strict=True)),
    "pairs of groupby": lambda tables: [(n, table) for n, table in enumerate(tables)],
    "groupby": grouped,
    "panel": lambda tables: pd.concat(tables, keys=range(len(tables))),
    "panel with names": lambda tables: pd.concat(tables, keys=[*"abc"], names=["run", "t"]),
    "data sets": lambda tables: [to_xarray(table) for table in tables],
    "arrays of xarray": lambda tables: [
        to_xarray(table).to_dataarray("component") for table in tables
    ],
    "lazy frames": lambda tables: [LazyFrame(table) for table in tables],
}
INDICES = {
    "rows": range(40),
    "rows from 7 on": range(7, 47),
    "every third row": range(0, 120, 3),
    "whole floats": np.arange(40.0),
    "times": SECONDS,
    "dates": DATES,
    "durations": pd.to_timedelta(SECONDS, unit="s"),
    "zone": DATES.tz_localize("Europe/Berlin"),
    "text": DATES.astype(str),
    "periods": DATES.to_period("250ms"),
}
HAS_COORDINATES = ("data sets", "arrays of xarray")
IN = [
    (container, index)
    for container, index in itertools.product(CONTAINERS, INDICES)
    if container not in HAS_COORDINATES or index in ("dates", "durations", "zone")
]
BAD_ROWS = {
    "hole": [*range(10), *range(15, 40)],
    "a single row": [*range(20), *range(21, 40)],
    "falling": [*range(39, -1, -1)],
    "twice": [*range(20), *range(20), *range(20, 40)],
    "shuffled": [*np.random.default_rng(0).permutation(40)],
}


def tables(index, rows=slice(None), columns="uv", name=None):
    index = pd.Index(INDICES[index], name=name)
    made = [pd.DataFrame(states, columns=[*"uv"], index=index) for states in RUNS]
    return [table[[*columns]].iloc[rows] for table in made]


@pytest.mark.parametrize(("container", "index"), IN)
def test_a_good_series_is_the_plain_array(container, index):
    given = labelled_series(CONTAINERS[container](tables(index)))
    assert given.labels == ("u", "v")
    np.testing.assert_array_equal(given.states, RUNS)
    if index in ("rows", "rows from 7 on", "every third row", "whole floats"):
        assert given.step is None
        with pytest.raises(ValueError, match="no column 'time'"):  # which a record must have
            measured_series(CONTAINERS[container](tables(index)), STEP)
        return
    assert given.step == pytest.approx(STEP)
    assert given.dated == (index != "times")
    step = STEP if index == "times" else f"{STEP} seconds"
    np.testing.assert_array_equal(measured_series(CONTAINERS[container](tables(index)), step), RUNS)


@pytest.mark.parametrize("rows", BAD_ROWS)
@pytest.mark.parametrize(("container", "index"), IN)
def test_rows_that_are_missing_or_in_disorder_are_refused_by_both_doors(container, index, rows):
    for call in (labelled_series, lambda given: measured_series(given, "0.25 seconds")):
        with pytest.raises((ValueError, TypeError)):
            call(CONTAINERS[container](tables(index, BAD_ROWS[rows])))


@pytest.mark.parametrize("library", ["stand-in", "polars", "pyarrow"])
@pytest.mark.parametrize("columns", ["uv", "vu"])
@pytest.mark.parametrize("clock", [None, "times", "dates"])
def test_frames_of_other_libraries_go_by_their_labels(library, columns, clock):
    plain = tables("rows", columns=columns)
    if clock is not None:
        plain = [table.assign(time=INDICES[clock]) for table in plain]
    as_frames = frames_of(library)
    if library == "stand-in":
        as_frames = lambda made: [OtherFrame({c: t[c].to_numpy() for c in t}) for t in made]  # noqa: E731
    given = labelled_series([*tables("rows")[:1], *as_frames(plain)[1:]])
    np.testing.assert_array_equal(given.states, RUNS)
    assert labelled_series(as_frames(plain)).labels == tuple(columns)
    if clock is not None:
        step = STEP if clock == "times" else pd.Timedelta("250ms")
        np.testing.assert_array_equal(measured_series(as_frames(plain), step, ["u", "v"]), RUNS)
        for rows in BAD_ROWS.values():
            with pytest.raises(ValueError, match="time"):
                labelled_series(as_frames([table.iloc[rows] for table in plain]))
    (single,) = as_frames(plain[:1])
    assert labelled_series(single).states.shape == (1, 40, 2)


@pytest.mark.parametrize("index", ["rows", "times", "dates"])
def test_frames_of_dask_are_computed(index):
    frame = pytest.importorskip("dask.dataframe")
    made = [frame.from_pandas(table, npartitions=2, sort=False) for table in tables(index)]
    given = labelled_series(made)
    np.testing.assert_array_equal(given.states, RUNS)
    assert given.step == (None if index == "rows" else pytest.approx(STEP))


def test_a_library_that_is_not_understood_is_told_the_way_to_pandas():
    class Lazy(OtherFrame):
        def __getitem__(self, name):
            raise TypeError("not subscriptable")

    with pytest.raises(TypeError, match=r"Lazy is no table .*: convert it .*\.to_pandas\(\)"):
        labelled_series(Lazy({"u": SECONDS}))


DATED_LABELS = tables("dates")[0]
REFUSED = [
    ({"u": SECONDS, "v": SECONDS}, TypeError, "are a dictionary of columns: one table of them is"),
    ({1.0, 2.0}, TypeError, "must be in an order, which a set has not"),
    ([{"u": 1.0}], TypeError, "each of the series must be .* not a dict"),
    ("lab.csv", TypeError, r"not the file 'lab.csv': read files by .*measured_series"),
    (["lab.csv"], TypeError, r"not the file 'lab.csv': read files by .*measured_series"),
    (
        pd.concat(tables("rows")),
        ValueError,
        "its index goes from 39 to 0 in row 41, as where tables were joined",
    ),
    (
        tables("rows")[0].set_index(pd.Index([0, 1, *range(1, 39)])),
        ValueError,
        "its index goes from 1 to 1 in row 3, as where tables were joined",
    ),
    (
        tables("rows")[0].drop(index=[7]),
        ValueError,
        "rows are missing between 6 and 8 of its index, .* if no row is missing, reset_index",
    ),
    (
        tables("rows")[0].set_index(pd.Index([f"row {n}" for n in range(40)])),
        ValueError,
        "its index is neither times nor row numbers, since it has 'row 0'",
    ),
    (
        tables("rows")[0].set_index(pd.CategoricalIndex([*"ab"] * 20)),
        ValueError,
        "its index is neither times nor row numbers",
    ),
    (
        pd.concat(tables("rows"), axis=1, keys=[*"abc"]),
        ValueError,
        r"columns of 2 levels, such as \('a', 'u'\)",
    ),
    (
        [DATED_LABELS, DATED_LABELS.rename(columns={"u": "u "})],
        ValueError,
        "'u' and 'u ' differ in blanks alone",
    ),
    (
        [
            DATED_LABELS.rename(columns={"u": unicodedata.normalize(form, "ü")})
            for form in ("NFC", "NFD")
        ],
        ValueError,
        "differ in how their characters are composed alone",
    ),
    (xarray.Variable("time", SECONDS), TypeError, "not a Variable of xarray"),
    (
        pd.concat(tables("dates"), keys=range(3), names=["run", "time"]).swaplevel().sort_index(),
        ValueError,
        r"whose outer index level is called time, of 3 rows at most: .* table.swaplevel\(\)",
    ),
    (
        pd.concat(tables("rows"), keys=range(3)).swaplevel().sort_index(),
        ValueError,
        r"whose outer index level has 40 entries, of 3 rows at most: .* table.swaplevel\(\)",
    ),
    (tables("rows")[0].to_dict("series"), TypeError, "are a dictionary of columns"),
    ({"u": pd.Series(SECONDS), "v": pd.Series(SECONDS)}, TypeError, "a dictionary of columns"),
    (tables("rows")[0].to_records(), TypeError, r"not records: give pd.DataFrame\(records\)"),
    (tables("dates")[0].resample("5s"), TypeError, "be an array .* not a DatetimeIndexResampler"),
    (tables("rows")[0].rolling(10), TypeError, "must be an array .* not a Rolling"),
    ({"a": RUNS[0]}.keys(), TypeError, "must be an array .* not a dict_keys"),
    ([tables("rows")[:2], tables("rows")[2:]], TypeError, "not a list of tables"),
    ([tables("rows")[0], None], TypeError, "not a NoneType"),
    ([tables("rows")[0].astype(object)], ValueError, r"but object; .* table.astype\(float\)"),
    ([tables("rows")[0].astype(str)], ValueError, r"'u' has no numbers, .* table.astype\(float\)"),
    (
        [np.float64(1.0), np.float64(2.0)],
        ValueError,
        r"must be \(series, time, component\), not \(2,\)",
    ),
    (
        pd.DataFrame({"date": pd.to_datetime(DATES), "u": SECONDS}),
        ValueError,
        "column 'date' has no numbers, but dates: if it is the clock, call it 'time'",
    ),
    (
        tables("rows")[0].assign(hour=DATES.astype(str)).drop(index=[7]),
        ValueError,
        "column 'hour' has no numbers, but dates: .* 'time'}.*, or else leave it out",
    ),
    (
        xarray.Dataset(
            {"u": ("time", SECONDS)}, coords={"date": ("time", np.array(DATES, "M8[ns]"))}
        ),
        ValueError,
        "has the coordinate 'date' along its dimension 'time'",
    ),
]


@pytest.mark.parametrize(("data", "error", "message"), REFUSED)
def test_what_is_not_understood_is_refused_by_name(data, error, message):
    with pytest.raises(error, match=message):
        labelled_series(data)


@pytest.mark.parametrize("keys", ["run", ["run"], pd.Grouper(key="run")])
@pytest.mark.parametrize("selected", [None, ["u", "v"]])
def test_groups_leave_the_column_that_they_are_grouped_by(keys, selected):
    together = pd.concat([t.assign(run=n) for n, t in enumerate(tables("rows"))])
    groups = together.groupby(keys)
    given = labelled_series(groups if selected is None else groups[selected])
    assert given.labels == ("u", "v")
    np.testing.assert_array_equal(given.states, RUNS)
    one = labelled_series(together.groupby("run")["v"])
    assert one.labels == ("v",)
    np.testing.assert_array_equal(one.states, RUNS[..., 1:])


@pytest.mark.parametrize("by", ["run", ["run"], ["run", "place"]])
def test_groups_of_polars_are_in_the_order_of_their_keys(by):
    polars = pytest.importorskip("polars")
    runs = [
        polars.DataFrame({"run": [10 - n] * 40, "place": ["x"] * 40, "u": u, "v": v})
        for n, (u, v) in enumerate(RUNS.transpose(0, 2, 1))
    ]
    together = polars.concat(runs if "place" in by else [t.drop("place") for t in runs])
    for _ in range(4):  # polars has another order each time
        given = labelled_series(together.group_by(by))
        assert given.labels == ("u", "v")
        np.testing.assert_array_equal(given.states, RUNS[::-1])
    kept = labelled_series(together.group_by(by, maintain_order=True))
    np.testing.assert_array_equal(kept.states, RUNS)


class ArrowTable(OtherFrame):
    """A table of pyarrow that was made from one of pandas, with its index as a column."""

    def __init__(self, table):
        index = {} if isinstance(table.index, pd.RangeIndex) else {"__index_level_0__": table.index}
        super().__init__({**{name: table[name].to_numpy() for name in table}, **index})
        self.schema = type("Schema", (), {"pandas_metadata": {}})
        self.to_pandas = lambda: table


@pytest.mark.parametrize("library", ["stand-in", "pyarrow"])
def test_tables_of_pyarrow_keep_the_index_of_pandas(library):
    made = ArrowTable
    if library == "pyarrow":
        made = pytest.importorskip("pyarrow").Table.from_pandas
    dated = labelled_series([made(table) for table in tables("dates")])
    assert (dated.labels, dated.step) == (("u", "v"), pytest.approx(STEP))
    np.testing.assert_array_equal(dated.states, RUNS)
    with pytest.raises(ValueError, match="rows are missing between 6 and 8 of its index"):
        labelled_series(made(tables("rows")[0].drop(index=[7])))


def test_panels_of_many_short_runs_have_a_clock_or_are_a_list():
    short = [table.iloc[:3] for table in tables("dates")] * 3
    panel = pd.concat(short, keys=range(9))
    assert labelled_series(panel).states.shape == (9, 3, 2)
    numbered = pd.concat([table.reset_index(drop=True) for table in short], keys=range(9))
    with pytest.raises(ValueError, match="outer index level has 9 entries, of 3 rows at most"):
        labelled_series(numbered)
    as_list = [table for _, table in numbered.groupby(level=0)]
    assert labelled_series(as_list).states.shape == (9, 3, 2)
    assert labelled_series(dict(enumerate(short)).values()).states.shape == (9, 3, 2)


def test_dates_of_python_and_coordinates_that_are_no_components():
    days = [datetime.date(2020, 1, 1) + datetime.timedelta(days=n) for n in range(40)]
    given = labelled_series(pd.DataFrame(RUNS[0], index=days, columns=[*"uv"]))
    assert (given.step, given.dated) == (86400.0, True)
    with_depth = xarray.Dataset(
        {"u": ("time", SECONDS**2)}, coords={"time": SECONDS, "depth": ("time", SECONDS)}
    )
    assert labelled_series(with_depth).labels == ("u",)


# -- clocks ----------------------------------------------------------------------------------------
JITTERED = SECONDS + 0.2 * STEP * np.random.default_rng(1).uniform(-1, 1, 40) * (SECONDS % 1 > 0)
LONG = np.arange(5000.0)
CLOCKS = {
    "exact": (0.02 * LONG, None),
    "jitter": (JITTERED, None),
    "rounded": (np.round(0.25 * LONG + 0.01, 1), None),
    "single precision": ((1e5 + 0.02 * LONG).astype(np.float32).astype(float), None),
    "single precision, late": ((3e5 + 0.08 * LONG).astype(np.float32).astype(float), None),
    "gap": (np.delete(0.02 * LONG, [70, 71]), "gap"),
    "gap in ten steps": (np.delete(LONG[:12], 7), "gap"),
    "two gaps": (np.delete(0.02 * LONG, [70, 900]), "gap"),
    "rate": (np.r_[0.02 * LONG, 100 + 0.0205 * LONG], "rate"),
    "slow change of rate": (0.02 * LONG * (1 + 1e-5 * LONG), "rate"),
    "double rate": (np.r_[0.02 * LONG, 100 + 0.04 * LONG], "rate"),
}


@pytest.mark.parametrize("name", CLOCKS)
def test_jitter_and_rounding_are_told_apart_from_gaps_and_changes_of_rate(name):
    times, kind = CLOCKS[name]
    found = irregularity(times)
    assert (found.kind if found else None) == kind
    table = pd.DataFrame({"time": times, "u": np.sin(times)})
    step = (times[-1] - times[0]) / (len(times) - 1)
    for call in (labelled_series, lambda given: measured_series(given, step)):  # they say the same
        if kind is None:
            call(table)
        else:
            with pytest.raises(ValueError, match="rate" if kind == "rate" else "gap"):
                call(table)


def test_a_clock_in_single_precision_has_no_gaps_that_cut():
    times = CLOCKS["single precision"][0]
    table = pd.DataFrame({"time": times, "u": np.sin(times)})
    assert measured_series(table, 0.02, shortest=50, cut_gaps=True).shape == (1, 5000, 1)


@pytest.mark.parametrize("missing", [40, 400])
def test_the_step_of_all_samples_counts(missing):
    """1.001 times the step is off by a row after a thousand, by whichever door."""
    frame = pd.DataFrame({"time": 0.02002 * np.arange(missing), "u": np.sin(np.arange(missing))})
    given = labelled_series(frame)
    refused = missing > 0.5 / 0.001
    for call in (lambda: given.check_step(0.02, "x"), lambda: measured_series(frame, 0.02)):
        if refused:
            with pytest.raises(ValueError, match=r"0\.02002"):
                call()
        else:
            call()


@pytest.mark.parametrize("step", [0.01, 12.0, 30.0, 100000.0])
def test_rows_that_are_there_twice_are_no_clock_that_goes_round(step):
    table = pd.DataFrame({"time": step * np.r_[0:20, 19:40], "u": np.sin(np.arange(41))})
    for call in (labelled_series, lambda given: measured_series(given, step)):
        with pytest.raises(ValueError, match=r"stays at .* Remove rows that are there twice"):
            call(table)


def test_trading_days_have_no_clock():
    days = pd.bdate_range("2020-01-01", periods=40)
    traded = pd.DataFrame(RUNS[0], columns=[*"uv"], index=days)
    with pytest.raises(ValueError, match="as trading days do, leave the times out"):
        labelled_series(traded)
    without = labelled_series(traded.reset_index(drop=True))
    np.testing.assert_array_equal(without.states, RUNS[:1])


@pytest.mark.parametrize("bits", [16, 24, 31, 32])
@pytest.mark.parametrize("unit", [1, 1e-3])
def test_clocks_that_go_round(bits, unit):
    counts = (2**bits - 2000 + 10 * np.arange(400)) % 2**bits * unit
    table = pd.DataFrame({"time": counts, "u": np.sin(np.arange(400))})
    for call in (labelled_series, lambda given: measured_series(given, 10 * unit)):
        with pytest.raises(ValueError, match=rf"a clock went round: add 2\*\*{bits}( / 1000)? to"):
            call(table)


# -- columns that are no state, and units ----------------------------------------------------------


ROWS = np.arange(400.0)
DAYS = pd.date_range("1999-11-03", periods=400)
CONSTANT = {"run": lambda n: np.full(400, float(n))}
COUNTING = {
    "stamp": lambda n: 1.7e9 + 600 * ROWS + 1e6 * n,
    "stamp of a clock that jitters": lambda n: 600 * ROWS + 30 * np.sin(ROWS + n),
    "stamp with gaps": lambda n: 600 * (ROWS + ROWS // 50) + 1e6 * n,
    "stamp in single precision": lambda n: np.float32(1.7e9 + 600 * ROWS),
    "days": lambda n: (ROWS + n) / 7,
    "countdown": lambda n: 300 - ROWS,
    "year of months": lambda n: 1990 + n + (ROWS + n) // 12,
    "year of days": lambda n: np.float64(DAYS.year) + n,
    "year, within one for some": lambda n: 2000 + (n + (ROWS > 200) * (n > 1)),
    "year of three": lambda n: 2000 + min(n, 2) + (ROWS > 200) * (n > 1),
    "run in one table": lambda n: np.repeat([1.0, 2.0, 3.0, 4.0], [50, 120, 30, 200]),
}
CYCLIC = {
    "hour": lambda n: ROWS % 24,
    "one of three": lambda n: ROWS % 3,
    "hour of half hours": lambda n: (ROWS // 2 + n) % 24,
    "hour with minutes": lambda n: (ROWS * 7 / 60 + n) % 24,
    "hours to go": lambda n: 23 - ROWS % 24,
    "month": lambda n: np.float64(DAYS.month),
    "day of the month": lambda n: np.float64(DAYS.day),
    "day of the week": lambda n: np.float64(DAYS.day_of_week),
    "day of the year": lambda n: np.float64(DAYS.day_of_year),
    "index of joined tables with holes": lambda n: np.flatnonzero(n != ROWS % 9)[:300] % 150,
    "index of joined tables": lambda n: np.concatenate([np.arange(150.0), np.arange(250.0)]),
}


def uneven(seed, values):
    """Values that stay for random times."""
    generator = np.random.default_rng(seed)
    return np.repeat(values, generator.integers(1, 9, size=len(values)))[:400]


STATES = {
    "same in all": lambda n: np.full(400, 4.0),
    "wave": lambda n: np.sin(ROWS + n),
    "season": lambda n: np.cos(2 * np.pi * (ROWS + n) / 24),
    "ramp and wave": lambda n: ROWS + 3 * np.sin(ROWS),
    "constant in one": lambda n: np.full(400, 1.0) if n else np.sin(ROWS),
    "spikes": lambda n: np.float64(np.random.default_rng(n).random(400) > 0.9),
    "rain": lambda n: np.maximum(0, np.random.default_rng(n).normal(size=400)),
    "counts": lambda n: np.float64(np.random.default_rng(n).poisson(0.4, size=400)),
    "counts that are reset": lambda n: uneven(n, np.arange(400) % 4),
    "random walk of a grid": lambda n: np.random.default_rng(n).integers(-1, 2, 400).cumsum(),
    "decay": lambda n: np.exp(-ROWS / 100),
    "ramps, one of which does not rise": lambda n: n * ROWS,
    "dry but in one": lambda n: np.where(ROWS > 300, 1.0, 0.0) if n == 1 else np.zeros(400),
}


@pytest.mark.parametrize("name", [*CONSTANT, *COUNTING, *CYCLIC, *STATES])
def test_columns_that_are_no_state(name):
    made = {**CONSTANT, **COUNTING, **CYCLIC, **STATES}[name]
    columns = [made(n) for n in range(4)]
    series = [np.stack([np.sin(ROWS[: len(each)]), each], axis=1) for each in columns]
    found = columns_of_no_state(["u", name], series)
    expected = [[name] * (name in kinds) for kinds in (CONSTANT, COUNTING, CYCLIC)]
    assert [*found] == expected


@pytest.mark.parametrize("form", ["array", "data set", "file"])
def test_units_of_values_must_be_the_same(form, tmp_path):
    def made(unit, number):
        array = xarray.DataArray(
            RUNS[number], dims=("time", "component"), coords={"time": SECONDS}, name="T"
        )
        array.attrs["units"] = unit
        if form == "array":
            return array
        data = array.to_dataset()
        data.to_netcdf(tmp_path / f"{number}.nc")
        return data if form == "data set" else tmp_path / f"{number}.nc"

    same = [made("degC", n) for n in (0, 1)]
    np.testing.assert_array_equal(measured_series([*same, made("", 2)], STEP), RUNS)
    doors = [lambda given: measured_series(given, STEP)]
    doors += [labelled_series] if form != "file" else []
    for call in doors:
        with pytest.raises(ValueError, match=r"has the unit 'K' in .* and 'degC' in .*: convert"):
            call([*same, made("K", 2)])


def test_units_go_by_the_labels_of_components():
    def made(*names, **units):
        return xarray.Dataset(
            {name: ("time", np.sin(SECONDS), {"units": units[name]}) for name in names},
            {"time": SECONDS},
        )

    first = made("u", "v", u="m/s", v="Pa")
    assert labelled_series([first, made("v", "u", u="m/s", v="Pa")]).units == ("m/s", "Pa")
    told = "'v' has the unit 'hPa' in series 3 and 'Pa' in series 1"
    for names in ("uv", "vu"):
        with pytest.raises(ValueError, match=told):
            labelled_series([first, first, made(*names, u="m/s", v="hPa")])


# -- what arrays of xarray are called --------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "axes", "labels"),
    [
        (None, ["time"], None),
        ("time", ["time"], None),
        ("u", ["time"], ("u",)),
        (None, ["time", "component"], None),
        ("u", ["time", "component"], None),
    ],
)
def test_an_array_has_the_label_that_it_is_called(name, axes, labels):
    values = RUNS[0] if len(axes) == 2 else RUNS[0, :, 0]
    coordinates = {} if name == "time" else {"time": SECONDS}
    array = xarray.DataArray(values, dims=axes, coords=coordinates, name=name)
    assert labelled_series([array]).labels == labels


def test_labels_may_be_objects_of_python():
    entries = np.array(["u", "vw"], dtype=object)
    array = xarray.DataArray(
        RUNS[0], dims=["time", "component"], coords={"time": SECONDS, "component": entries}
    )
    assert labelled_series([array]).labels == ("u", "vw")


def test_series_that_end_early_have_times_of_their_own_samples():
    states = RUNS.copy()
    states[1, 30:] = np.nan
    data = xarray.Dataset({"u": (("series", "time"), states[:, :, 0])}, {"time": SECONDS})
    runs = NamedArrays("data", data).runs(["u"], None)
    for run, length in zip(runs, (40, 30, 40), strict=True):
        assert np.array_equal(run.columns["time"], SECONDS[:length])
        assert len(run.columns["u"]) == length


# -- one observation -------------------------------------------------------------------------------


def test_observations_carry_their_times():
    table = tables("dates")[0]
    expected = RUNS[0, 5]
    array = table.rename_axis("time").to_xarray()
    for row in (
        table.iloc[5],
        next(itertools.islice(table.iterrows(), 5, None))[1],
        table.iloc[[5]],
        table.assign(time=DATES).reset_index(drop=True).iloc[5],
        array.isel(time=5),
        array.to_dataarray("component").isel(time=[5]),
        {"time": DATES[5], "u": expected[0], "v": expected[1]},
    ):
        values, labels, time, number = observation_of(row)
        np.testing.assert_array_equal(values, expected)
        assert (labels, pd.Timestamp(time), number) == (("u", "v"), DATES[5], None)
    assert observation_of(tables("rows")[0].iloc[5])[2:] == (None, 5)
    with pytest.raises(ValueError, match="several levels"):
        observation_of(pd.concat(tables("rows"), keys=[*"abc"]).iloc[5])


def test_the_package_takes_no_time_to_load():
    assert burstcast.EventForecaster


def test_fields_of_a_data_set_are_named_and_not_left_out_in_silence(tmp_path):
    """Variables with times and other dimensions; bounds of cells and what has no times are none."""
    grid = {"latitude": [10.0, 20.5], "longitude": [0, 1]}
    wind = np.random.default_rng(3).normal(size=(len(SECONDS), 2, 2))
    data = xarray.Dataset(
        {
            "index": ("time", np.sin(SECONDS)),
            "wind": (("time", *grid), wind),
            "height": (tuple(grid), np.ones((2, 2))),
            "time_bnds": (("time", "bnds"), np.stack([SECONDS, SECONDS + 1], axis=1)),
        },
        {"time": SECONDS, **grid},
    )
    step = float(SECONDS[1] - SECONDS[0])
    path = tmp_path / "wind.nc"
    data.to_netcdf(path)
    told = r"has wind \(time, latitude, longitude\) beside index: rename the other dimension"
    for read in (labelled_series, lambda given: measured_series(given, step)):
        with pytest.raises(ValueError, match=told):
            read(data)
    with pytest.raises(ValueError, match=told):
        measured_series(str(path), step)
    assert measured_series(data, step, ["index"]).shape == (1, len(SECONDS), 1)
    assert labelled_series(data.drop_vars("wind")).labels == ("index",)
    stacked = labelled_series(data.stack(component=[*grid]))
    assert stacked.labels == ("index", "c10_0", "c10_1", "c20.5_0", "c20.5_1")
    np.testing.assert_array_equal(stacked.states[0, :, 1:], wind.reshape(len(SECONDS), 4))
