"""Files of measured series: exactly their numbers, or a message with the place and the mend."""

import base64
import zlib

import netCDF4
import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.data.series_files import content_of, read_runs

STATES = np.random.default_rng(1).normal(size=(3, 7, 2))  # (series, time, component)


def runs(path, *names, unit=None):
    return read_runs(str(path), names or ("u", "v"), unit)


def states(found, *names):
    return np.stack([np.stack([run.columns[name] for name in names], axis=1) for run in found])


def write_netcdf(path, variables, **how):
    with netCDF4.Dataset(path, "w", **how) as file:
        for name, (dimensions, data) in variables.items():
            for dimension, length in zip(dimensions, np.shape(data), strict=True):
                if dimension not in file.dimensions:
                    file.createDimension(dimension, length)
            kind = str if np.asarray(data).dtype.kind == "U" else "f8"
            file.createVariable(name, kind, dimensions)[...] = np.asarray(
                data, dtype=object if kind is str else float
            )


def test_a_table_to_the_last_digit(tmp_path):
    path = tmp_path / "a.csv"
    values = np.random.default_rng(2).normal(size=(2000, 2)) * 10.0 ** np.arange(-1000, 1000)[
        :, None
    ].clip(-300, 300)
    table = pd.DataFrame(values, columns=["u", "v"]).assign(note="text", time=range(2000))
    table.to_csv(path, index=False)
    assert content_of(str(path)).names == ["u", "v", "note"]
    (found,) = runs(path)
    assert found.name == str(path)
    assert np.array_equal(states([found], "u", "v")[0], values)
    assert np.array_equal(found.columns["time"], np.arange(2000))


def test_gaps_and_what_is_declared_as_missing_are_nan(tmp_path):
    # wherever they are: an empty last cell is one as any other
    path = tmp_path / "a.csv"
    path.write_text("time,u,v\n0,1,2\n1,,4\n2,nan,\n3,NA,\n")
    (found,) = runs(path)
    assert np.array_equal(found.columns["u"], [1, *[np.nan] * 3], equal_nan=True)
    assert np.array_equal(found.columns["v"], [2, 4, np.nan, np.nan], equal_nan=True)
    path = tmp_path / "a.nc"
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("time", 7)
        file.createVariable("u", "f4", ("time",), fill_value=-1.0)[...] = np.arange(7) - 1.0
    (found,) = runs(path, "u")
    assert np.array_equal(found.columns["u"], [np.nan, *range(6)], equal_nan=True)


@pytest.mark.parametrize(
    "text",
    [
        "\ufeff# lab\n\ntime,u,v\n0,1.5,2\n1,3,-4e1\n\n",
        '"time","u", v\n0,1.5, 2\n1 , 3 ,-40',
        "v,u,time\r\n2,1.5,0\r\n-40,3,1\r\n",
        "time,u,v,note\r0,1.5,2,x y\r1,3,-40,\r",
    ],
)
def test_dialects_of_csv(tmp_path, text):
    path = tmp_path / "a.csv"
    path.write_text(text, encoding="utf-8", newline="")
    (found,) = runs(path)
    assert np.array_equal(states([found], "u", "v")[0], [[1.5, 2], [3, -40]])
    assert found.columns["time"].tolist() == [0, 1]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        ("# u\n\n", "is empty"),
        ("time,u,v\n", "has a header, but no rows"),
        ("time,µ,u,v\n0,1,2,3\n".encode("latin-1"), "is not written in UTF-8"),
        ("time,u,v\n0,1,2\n".encode("utf-16"), "is not written in UTF-8"),
        # headers
        ("0,1,2\n3,4,5\n", "line 1 has numbers where the names of the columns are expected"),
        ("# time,u,v\n0.5,1,2\n", "line 2 has numbers where the names of the columns are exp"),
        (",u,v\n2009-08-01,1,2\n", "line 1: column 1 has no name: pandas writes an index so; call"),
        ("time,u,v,\n0,1,2,\n", "line 1: column 4 has no name"),
        ("time,u,v,u\n0,1,2,3\n", "has 2 columns that are called 'u'"),
        ("time;u;v\n0;1;2\n", "fields are separated by commas"),
        ("time\tu\tv\n0\t1\t2\n", "fields are separated by commas"),
        ("flow rate v\n1 2\n", "fields are separated by commas"),
        # more fields or fewer: decimal commas, thousands, a trailing comma, blank lines, comments
        ("# x\ntime,u,v\n0,1,2\n1,3,4,5\n", "line 4 has 4 fields, but the header has 3"),
        ("time,u,v\n0,1,5,2\n", "line 2 has 4 fields, but the header has 3"),
        ("time,u,v\n0,1,2\n1,1,000,2\n", "line 3 has 4 fields, but the header has 3"),
        ("time,u,v\n0,1,2\n1,3\n", "line 3 has 2 fields, but the header has 3"),
        ("time,u,v\n0,1,2\n\n1,3,4\n", "line 3 has no fields"),
        ("time,u,v\n0,1,2\n# run 2\n1,3,4\n", "line 3 has 1 fields"),
        ('time,u,v\n0,"1","2"\n', "line 2 has a quotation mark: leave columns of text out"),
        # fields
        ("time,u,v\n0,1,2\n1,3,error\n", "line 3: column 'v' has 'error', which is no number"),
        ("time,u,v\n0,1,10#15\n", "line 2: column 'v' has '10#15', which is no number"),
        ("time,u,v\n0,1,1_0\n", "line 2: column 'v' has '1_0', which is no number"),
        ("time,u,v\n0,########,2\n", "line 2: column 'u' has '########'"),
        ("time,u,v\n0,1,2\n1,#WERT!,4\n", "line 3: column 'u' has '#WERT!'"),
        ("time,u,v\n0,TRUE,2\n", "line 2: column 'u' has 'TRUE'"),
        ("time,u,v\n0,1\f2,2\n", r"line 2: column 'u' has '1\x0c2'"),
        ("time,u,v\n0,1,2\ntime,u,v\n1,2,3\n", "line 3: column"),
        # times
        ("time,u,v\n1970-01-01,1,2\n", "line 2: column 'time' has the date '1970-01-01', but"),
        ("time,u,v\n1749-01,1,2\n", "line 2: column 'time' has '1749-01', which is neither"),
        ("time,u,v\n0,1,2\n1970-01-02,3,4\n", "line 3: column 'time' has '1970-01-02', which is"),
        ("time,u,v\nnoon,1,2\n", "line 2: column 'time' has 'noon', which is neither"),
    ],
)  # fmt: skip
def test_tables_with_mistakes(tmp_path, text, message):
    path = tmp_path / "a.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(ValueError, match=r"a\.csv") as caught:
        runs(path)
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("second", "message"),
    [
        ("", "line 3: column 'time' has no time; each row needs one"),
        ("1970-01-01T02:00Z", "line 3: column 'time' has '1970-01-01T02:00Z', which is of another"),
        ("24", "line 3: column 'time' has '24', which is of another form than the rows before"),
        ("1970-02-30", "line 3: column 'time' has '1970-02-30', which is no date of the calendar"),
        ("1.1.1970", "line 3: column 'time' has '1.1.1970', which is neither a number nor a date"),
    ],
)
def test_dates_with_mistakes(tmp_path, second, message):
    path = tmp_path / "a.csv"
    path.write_text(f"time,u,v\n1970-01-01,1,2\n{second},3,4\n")
    with pytest.raises(ValueError, match=r"a\.csv") as caught:
        runs(path, unit="hour")
    assert message in str(caught.value)


def test_dates(tmp_path):
    path = tmp_path / "a.csv"
    for stamps, expected in (
        (["1970-01-01", "1970-01-01T12:30", "1970-01-02 00:00:00"], [0, 12.5, 24]),
        (["1970-01-01T00:00+01:00", "1970-01-01T01:00Z", "1970-01-01 03:30-0030"], [-1, 1, 4]),
        (["0", "1.5", "3"], [0, 1.5, 3]),
    ):
        path.write_text("time,u,v\n" + "".join(f"{stamp},1,2\n" for stamp in stamps))
        (found,) = runs(path, unit="hour")
        assert found.columns["time"].tolist() == expected


def test_parquet_and_its_index(monkeypatch):
    stamps = pd.to_datetime(["1970-01-01 00:00", "1970-01-01 12:30"])
    for table, expected in (
        (pd.DataFrame({"time": stamps, "u": [1, None]}), [0, 12.5]),
        (pd.DataFrame({"u": [1, None]}, index=stamps.rename("time")), [0, 12.5]),
        (pd.DataFrame({"time": stamps.tz_localize("Europe/Berlin"), "u": [1, None]}), [-1, 11.5]),
        (pd.DataFrame({"time": [0, 12.5], "u": [1, None]}).convert_dtypes(), [0, 12.5]),
    ):
        monkeypatch.setattr(pd, "read_parquet", lambda path, table=table: table)  # of any library
        (found,) = runs("a.parquet", "u", unit="hour")
        assert found.columns["time"].tolist() == expected
        assert np.array_equal(found.columns["u"], [1, np.nan], equal_nan=True)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"time": [0, 1], "u": ["1", "2"]}, "column 'u' has no numbers, but"),
        ({"time": [0, 1], "u": pd.to_datetime([1, 2])}, "column 'u' has no numbers, but datetime"),
        ({"time": [0, 1], "u": [1j, 2]}, "column 'u' has no numbers, but complex"),
        ({"time": ["a", "b"], "u": [1, 2]}, "column 'time' has no numbers"),
        ({"time": pd.to_datetime([1, 2]), "u": [1, 2]}, "'time' has dates, but the time step has"),
        ({"time": [], "u": []}, "has no rows"),
    ],
)
def test_parquet_with_mistakes(monkeypatch, table, message):
    monkeypatch.setattr(pd, "read_parquet", lambda path: pd.DataFrame(table))
    with pytest.raises(ValueError, match=rf"^a\.parquet.*{message}"):
        runs("a.parquet", "u")


def test_parquet_without_pyarrow(tmp_path, monkeypatch):
    def missing(path):
        raise ImportError

    monkeypatch.setattr(pd, "read_parquet", missing)
    with pytest.raises(ValueError, match="takes pyarrow, which is not installed"):
        runs(tmp_path / "a.parquet")


def test_variables_of_netcdf(tmp_path):
    path = tmp_path / "a.nc"
    flow = {
        "u": (("series", "time"), STATES[:, :, 0]),
        "v": (("time", "series"), STATES[:, :, 1].T),
    }
    write_netcdf(
        path, {**flow, "w": (("time",), np.arange(7.0)), "time": (("time",), np.arange(7.0))}
    )
    found = runs(path, "u", "v", "w")
    assert np.array_equal(states(found, "u", "v"), STATES)
    assert all(
        np.array_equal(run.columns[name], np.arange(7.0)) for run in found for name in ("w", "time")
    )
    assert [run.name for run in found] == [f"{path}, series {number}" for number in (1, 2, 3)]


def test_components_by_their_labels(tmp_path):
    path = tmp_path / "a.nc"
    state = {"state": (("time", "component", "series"), STATES.transpose(1, 2, 0))}
    write_netcdf(path, {**state, "component": (("component",), np.array(["v", "u"]))})
    assert content_of(str(path)).names == ["v", "u"]
    assert np.array_equal(states(runs(path), "v", "u"), STATES)
    write_netcdf(path, state)
    assert np.array_equal(states(runs(path, "c1", "c2"), "c1", "c2"), STATES)
    write_netcdf(path, {**state, "other": (("time", "component"), STATES[0])})
    with pytest.raises(ValueError, match=r"a\.nc has 'c1' in state and in other: keep one of"):
        runs(path, "c1")


@pytest.mark.parametrize(
    ("variables", "message"),
    [
        (
            {"u": (("time", "rig"), STATES[:, :, 0])},
            r"has no variable with the dimensions series, ",
        ),
        ({"u": (("series",), [1.0, 2])}, r"it has u \(series\): rename them"),
        ({"u": (("series", "time"), STATES[:, :, 0]), "v": (("time", "v"), STATES[0])}, "no col"),
    ],
)
def test_dimensions_of_other_names(tmp_path, variables, message):
    path = tmp_path / "a.nc"
    write_netcdf(path, variables)
    from burstcast.data.measured_data import Quantity
    from burstcast.data.records import needed_columns

    with pytest.raises(ValueError, match=rf"a\.nc.*{message}"):
        needed_columns(str(path), [Quantity("u"), Quantity("v")])


@pytest.mark.parametrize(
    ("units", "calendar", "expected"),
    [
        ("hours since 2020-03-01 06:00:00", "standard", "2020-03-01 06:00"),
        ("minutes since 2020-03-01", "proleptic_gregorian", "2020-03-01"),
        ("seconds since 2020-03-01", "standard", "2020-03-01"),
        ("days since 1970-01-01T00:00:00Z", "gregorian", "1970-01-01"),
        ("days since 1970-01-01 00:00:00 UTC", "gregorian", "1970-01-01"),
        ("hours since 2020-03-01 06:00 +01:00", "standard", "2020-03-01 05:00"),
    ],
)
def test_times_of_netcdf_are_what_the_file_says(tmp_path, units, calendar, expected):
    path = tmp_path / "a.nc"
    write_netcdf(path, {"u": (("time",), [1.0, 2]), "time": (("time",), [0.0, 60])})
    with netCDF4.Dataset(path, "a") as file:
        file["time"].units, file["time"].calendar = units, calendar
    (found,) = runs(path, "u", unit="minute")
    scale = {"h": 60, "m": 1, "d": 1440, "s": 1 / 60}[units[0]]
    first = (pd.Timestamp(expected) - pd.Timestamp(0)) / pd.Timedelta("1min")
    assert found.columns["time"].tolist() == [first, first + 60 * scale]
    assert runs(path, "u")[0].columns["time"].tolist() == [0, 60]  # without a unit, numbers


@pytest.mark.parametrize(
    ("units", "calendar", "message"),
    [
        ("months since 2020-03-01", "standard", "has the units 'months since 2020-03-01'"),
        ("days since 2020-03-01", "360_day", "has the calendar 360_day"),
        ("days since noon", "standard", "whose date and zone are not written in ISO 8601"),
        ("days since 2020-03-01 06:00 CET", "standard", "whose date and zone are not written"),
    ],
)
def test_times_of_netcdf_that_are_refused(tmp_path, units, calendar, message):
    path = tmp_path / "a.nc"
    write_netcdf(path, {"u": (("time",), [1.0, 2]), "time": (("time",), [0.0, 60])})
    with netCDF4.Dataset(path, "a") as file:
        file["time"].units, file["time"].calendar = units, calendar
    with pytest.raises(ValueError, match=rf"a\.nc: 'time' .*{message}|a\.nc: 'time' {message}"):
        runs(path, "u", unit="minute")


@pytest.mark.parametrize("cut", [1, 8, 50])
def test_a_classic_netcdf_file_that_is_cut_off(tmp_path, cut):
    """The library of netCDF reads zeros for what is missing."""
    path = tmp_path / "a.nc"
    write_netcdf(path, {"u": (("time",), STATES[0, :, 0])}, format="NETCDF3_CLASSIC")
    assert np.array_equal(runs(path, "u")[0].columns["u"], STATES[0, :, 0])
    path.write_bytes(path.read_bytes()[:-cut])
    with pytest.raises(ValueError, match=r"a\.nc is cut off"):
        runs(path, "u")


def test_a_damaged_classic_file_is_not_opened_by_the_library_of_netcdf(tmp_path):
    """It dies of some, such as this one with a dimension of 2 ** 33 entries."""
    path = tmp_path / "a.nc"
    write_netcdf(path, {"u": (("time",), STATES[0, :, 0])}, format="NETCDF3_64BIT_DATA")
    content = bytearray(path.read_bytes())
    content[content.index(b"time") + 7] ^= 2
    path.write_bytes(content)
    with pytest.MonkeyPatch.context() as patch:
        patch.delattr(netCDF4, "Dataset")
        with pytest.raises(ValueError, match=r"a\.nc is cut off, or is no classic NetCDF file"):
            runs(path, "u")


HALF_PRECISION = (
    "c-rgqaB<`1lHy|K;9!7(|4_gJ6*7Q|$7$+y_<OhnF)>sy2_Y+l0WKy6Mg|5p9tI%ASh^Wzo(BWfK<7P?60j417BGr1FfcJ"
    "PGBQEsU^KG`1EZh<Ka?-Pz{SeI#Sdh$0$s<<#Q}6VGb01kYb-E>H!uu2u-&iVI>RU!1*2dTjDk@>7O-Kk0RY}LCE5"
)
"""An HDF5 file with two numbers of 16 bits, u."""


def test_hdf5_of_others(tmp_path):
    """Without names of dimensions; the library of NetCDF would die of the numbers in it."""
    path = tmp_path / "a.nc"
    path.write_bytes(zlib.decompress(base64.b85decode(HALF_PRECISION)))
    with pytest.raises(ValueError, match=r"a\.nc has no variable with the dimensions series, time"):
        runs(path, "u")


def test_arrays_of_numpy(tmp_path):
    path = tmp_path / "a.npy"
    np.save(path, STATES)
    assert np.array_equal(states(runs(path, "c1", "c2"), "c1", "c2"), STATES)
    with path.open("wb") as file:
        for run in STATES:
            np.save(file, run)
    with pytest.raises(ValueError, match=r"a\.npy cannot be read: it has more after its first arr"):
        runs(path)


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (np.full((1, 2, 3), 1j), "must consist of real numbers, not of complex128"),
        (np.full((1, 2, 3), "1.5"), "must consist of real numbers, not of <U3"),
        (np.full((1, 2, 3), None), "cannot be read: Object arrays"),
        (np.zeros((1, 2, 3), [("u", float)]), r"must consist of real numbers, not of \[\('u'"),
        (
            np.zeros((0, 2, 1)),
            r"has the shape \(0, 2, 1\); expected is \(series, time, component\)",
        ),
        (np.zeros((4, 2)), r"has the shape \(4, 2\); expected is \(series, time, component\)"),
        (np.zeros(4), r"has the shape \(4,\); .* such as array.reshape\(1, -1, 1\) of a single"),
    ],
)
def test_arrays_that_are_none_of_series(tmp_path, array, message):
    path = tmp_path / "a.npy"
    np.save(path, array)
    with pytest.raises(ValueError, match=rf"^[^ ]*a\.npy.*{message}"):
        runs(path)


@pytest.mark.parametrize("suffix", ["csv", "npy", "nc"])
def test_no_content(tmp_path, suffix):
    path = tmp_path / f"a.{suffix}"
    for content in (b"", b"\x00\x01PK\xff" * 9):
        path.write_bytes(content)
        with pytest.raises(ValueError, match=rf"^[^ ]*a\.{suffix}"):
            runs(path)


@pytest.mark.parametrize("suffix", ["mat", "h5", "txt", "npz"])
def test_other_files(tmp_path, suffix):
    with pytest.raises(ValueError, match=rf"a\.{suffix}: files of series end in .*data_recipes"):
        runs(tmp_path / f"a.{suffix}")


@pytest.mark.parametrize("suffix", ["csv", "nc", "npy", "parquet"])
def test_files_that_are_missing(tmp_path, suffix):
    with pytest.raises(
        ValueError, match=rf"a\.{suffix}: there is no such file, seen from /|pyarrow"
    ):
        runs(tmp_path / f"a.{suffix}")


# -- dialects and damage, by chance ----------------------------------------------------------------

CELLS = (
    lambda text: text.replace(".", ","),
    lambda text: text[:2] + "," + text[2:],
    lambda text: text + "#15",
    lambda text: text[:2] + "_" + text[2:],
    lambda text: text[:2] + " " + text[2:],
    lambda text: '"' + text,
    lambda text: text + '"',
    lambda text: "\N{MINUS SIGN}" + text,
    lambda text: "#DIV/0!",
    lambda text: "NA",
    lambda text: "",
)
"""What happens to a number in a table."""


def same_or_refused(path, expected, names):
    """Exactly the array, or a message that begins with the file; gaps are refused later on."""
    try:
        found, message = states(runs(path, *names), *names), str(path)
    except ValueError as error:
        found, message = expected, str(error)
    assert message.startswith(str(path))
    assert found.shape == expected.shape
    assert np.isnan(found).any() or np.array_equal(found, expected)


@settings(max_examples=300)
@given(data=st.data())
def test_damaged_tables(tmp_path_factory, data):
    draw, pick = data.draw, lambda *choices: data.draw(st.sampled_from(choices))
    path = tmp_path_factory.getbasetemp() / "fuzz.csv"
    names = pick(["u", "v"], ["v", "µ", "u"], ["u"])
    values = np.random.default_rng(draw(st.integers(0, 99))).normal(size=(4, len(names)))
    values = np.round(values, pick(0, 1, 17))
    separator, form = pick(",", ",", ",", ";", "\t", " "), pick(".17g", ".17e")
    table = [
        [str(number), *(f"{value:{form}}" for value in row)] for number, row in enumerate(values)
    ]
    table.insert(0, ["time", *names])
    row = draw(st.integers(1, 4))
    damage = pick("no", "cell", "more", "fewer", "shift", "last", "row", "header")
    if damage == "cell":
        table[row][1] = pick(*CELLS)(table[row][1])
    elif damage != "no":
        old = table[row]
        table[row] = {
            "more": [*old[:1], *old], "fewer": old[1:], "shift": [*old[1:], ""],
            "last": [*old, ""], "row": [pick("", "# run 2", "u")], "header": table[0],
        }[damage]  # fmt: skip
        table[row + 1 :] = [old] * (damage in ("row", "header")) + table[row + 1 :]
    text = pick("", "\ufeff", "# lab\n\n") + "\n".join(map(separator.join, table))
    text += pick("", "\n", "\n\n")
    path.write_text(text, encoding="utf-8", newline=pick("\n", "\r\n", "\r"))
    if damage != "shift":
        same_or_refused(path, values[np.newaxis], names)
        return
    try:  # a shifted row has another time, which the check of times finds, and a gap
        (found,), message = runs(path, *names), str(path)
        assert np.isnan(states([found], *names)).any()
    except ValueError as error:
        message = str(error)
    assert message.startswith(str(path))


@settings(max_examples=100)
@given(data=st.data())
def test_permuted_axes(tmp_path_factory, data):
    draw, pick = data.draw, lambda *choices: data.draw(st.sampled_from(choices))
    path = tmp_path_factory.getbasetemp() / f"fuzz.{pick('npy', 'nc')}"
    expected = np.random.default_rng(0).normal(size=draw(st.tuples(*[st.integers(2, 3)] * 3)))
    axes = ["series", "time", "component"]
    order = draw(st.permutations(axes)) if path.suffix == ".nc" else axes
    array = expected.transpose([axes.index(axis) for axis in order])
    if path.suffix == ".nc":
        write_netcdf(path, {"state": ([pick(axis, axis, f"{axis}_") for axis in order], array)})
    else:
        np.save(path, array)
    names = [f"c{number + 1}" for number in range(expected.shape[2])]
    try:
        known, message = content_of(str(path)).names, str(path)
    except ValueError as error:
        known, message = [], str(error)
    assert message.startswith(str(path))
    if known == names:
        same_or_refused(path, expected, names)
