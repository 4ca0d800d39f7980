"""Sources of measured series: exactly their numbers, or a message with the place and the mend."""

import base64
import datetime
import os
import re
import unicodedata
import zlib

import netCDF4
import numpy as np
import pandas as pd
import pytest
import xarray
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.data.measured_data import Quantity
from burstcast.data.series_files import content_of
from burstcast.data.times import times_in

STATES = np.random.default_rng(1).normal(size=(3, 7, 2))  # (series, time, component)


def runs(source, *names, unit=None):
    return content_of(source).read(names or ("u", "v"), unit)


def states(of_runs, *names):
    return np.stack([np.stack([run.columns[name] for name in names], axis=1) for run in of_runs])


def both(data, path):
    """What xarray holds, and a file of it."""
    data.to_netcdf(path)
    return data, path


def test_a_table_to_the_last_digit(tmp_path):
    path = tmp_path / "a.csv"
    values = np.random.default_rng(2).normal(size=(2000, 2)) * 10.0 ** np.arange(-1000, 1000)[
        :, None
    ].clip(-300, 300)
    table = pd.DataFrame(values, columns=["u", "v"]).assign(note="text", time=range(2000))
    table.to_csv(path, index=False)
    assert content_of(path).names == ["u", "v", "note"]
    (run,) = runs(path)
    assert run.name == str(path)
    assert np.array_equal(states([run], "u", "v")[0], values)
    assert np.array_equal(run.columns["time"], np.arange(2000))


def test_gaps_and_what_is_declared_as_missing_are_nan(tmp_path):
    # wherever they are: an empty last cell is one as any other
    path = tmp_path / "a.csv"
    path.write_text("time,u,v\n0,1,2\n1,,4\n2,nan,\n3,NA,\n")
    (run,) = runs(path)
    assert np.array_equal(run.columns["u"], [1, *[np.nan] * 3], equal_nan=True)
    assert np.array_equal(run.columns["v"], [2, 4, np.nan, np.nan], equal_nan=True)
    path = tmp_path / "a.nc"
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("time", 7)
        u = file.createVariable("u", "i2", ("time",), fill_value=-1)
        u.set_auto_maskandscale(False)
        u.valid_range, u.scale_factor = np.array([1, 4], "i2"), 0.5
        u[...] = np.arange(7) - 1
    (run,) = runs(path, "u")
    expected = np.array([np.nan, np.nan, 0.5, 1, 1.5, 2, np.nan])
    assert np.array_equal(run.columns["u"], expected, equal_nan=True)
    with netCDF4.Dataset(path, "a") as file:
        file["u"].add_offset = 10.0
    (run,) = runs(path, "u")
    assert np.array_equal(run.columns["u"], expected + 10, equal_nan=True)


def test_rows_may_be_short_and_not_empty(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("time,u\n0,\n1,2\n")
    (run,) = runs(path, "u")
    assert np.array_equal(run.columns["u"], [np.nan, 2], equal_nan=True)
    for text, row in (("time,u\n\n1,2\n", 2), ("time,u\n0,1\n\n1,2\n", 3)):
        path.write_text(text)
        with pytest.raises(ValueError, match=f"line {row} has no fields, but the header has 2"):
            runs(path, "u")


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
    (run,) = runs(path)
    assert np.array_equal(states([run], "u", "v")[0], [[1.5, 2], [3, -40]])
    assert run.columns["time"].tolist() == [0, 1]


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
        ("sep=,\ntime,u,v\n0,1,2\n", "line 1 is 'sep=,', which Excel writes to name the separator"),
        ("\ufeff\ufefftime,u,v\n0,1,2\n", r"'\ufefftime', has characters that are not seen"),
        ("time,u\u200b,v\n0,1,2\n", r"'u\u200b', has characters that are not seen"),
        # more fields or fewer: decimal commas, thousands, a trailing comma, blank lines, comments
        ("# x\ntime,u,v\n0,1,2\n1,3,4,5\n", "line 4 has 4 fields, but the header has 3"),
        ("time,u,v\n0,1,5,2\n", "line 2 has 4 fields, but the header has 3"),
        ("time,u,v\n0,1,2\n1,3\n", "line 3 has 2 fields, but the header has 3"),
        ("time,u,v\n0,1,2\n\n1,3,4\n", "line 3 has no fields"),
        ("time,u,v\n0,1,2\n# run 2\n1,3,4\n", "line 3 has 1 fields"),
        ('time,u,v\n0,"1","2"\n', "line 2 has a quotation mark: leave columns of text out"),
        # fields
        ("time,u,v\n0,1,2\n1,3,error\n", "line 3: column 'v' has 'error', which is no number"),
        ("time,u,v\n0,1,1_0\n", "line 2: column 'v' has '1_0', which is no number"),
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


MOMENTS = st.datetimes(datetime.datetime(1000, 1, 2), datetime.datetime(9999, 12, 30))
FORMS = ["%Y-%m-%d", "%Y-%m-%dT%H", "%Y%m%dT%H%M", "%Y-%m-%d %H:%M:%S.%f", "%Y%m%dT%H%M%S"]


@given(
    moments=st.lists(st.tuples(MOMENTS, st.sampled_from(FORMS)), min_size=1, max_size=4),
    zone=st.sampled_from(["", "Z", "+00", "+01", "-0330", "+05:45"]),
    unit=st.sampled_from([("second", 1), ("hour", 3600)]),
)
def test_dates_are_what_python_reads(moments, zone, unit):
    # those with a zone are clock times, all of them
    texts = [
        moment.strftime(form if "H" in form or not zone else FORMS[1]) for moment, form in moments
    ]
    texts = [text + zone for text in texts]
    expected = []
    for text in texts:
        read = datetime.datetime.fromisoformat(text)
        read = read if read.tzinfo else read.replace(tzinfo=datetime.UTC)
        since = read - datetime.datetime(1970, 1, 1, tzinfo=datetime.UTC)
        expected.append(since // datetime.timedelta(microseconds=1) / 1e6 / unit[1])
    np.testing.assert_allclose(times_in(texts, unit[0]), expected, rtol=1e-15)


STAMPS = pd.to_datetime(["1970-01-01 00:00", "1970-01-01 12:30"])


@pytest.mark.parametrize(
    ("table", "expected"),
    [
        (pd.DataFrame({"time": STAMPS, "u": [1, None]}), [0, 12.5]),
        (pd.DataFrame({"u": [1, None]}, index=STAMPS.rename("time")), [0, 12.5]),
        (pd.DataFrame({"time": STAMPS.tz_localize("Europe/Berlin"), "u": [1, None]}), [-1, 11.5]),
        (pd.DataFrame({"time": STAMPS.astype(str), "u": [1, None]}), [0, 12.5]),
        (pd.DataFrame({"time": STAMPS - STAMPS[0], "u": [1, None]}), [0, 12.5]),
        (pd.DataFrame({"time": [0, 12.5], "u": [1, None]}).convert_dtypes(), [0, 12.5]),
    ],
)
def test_tables_of_pandas_and_parquet(monkeypatch, table, expected):
    monkeypatch.setattr(pd, "read_parquet", lambda path: table)  # of any library
    for source in (table, "a.parquet"):
        (run,) = runs(source, "u", unit="hour")
        assert run.columns["time"].tolist() == expected
        assert np.array_equal(run.columns["u"], [1, np.nan], equal_nan=True)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"time": [0, 1], "u": ["1", "2"]}, ": column 'u' has no numbers, but"),
        (
            {"time": [0, 1], "u": pd.to_datetime([1, 2])},
            ": column 'u' has no numbers, but datetime",
        ),
        ({"time": [0, 1], "u": [1j, 2]}, ": column 'u' has no numbers, but complex"),
        ({"time": [0, 1], "u": [True, False]}, ": column 'u' has no numbers, but bool"),
        ({"time": ["0", "b"], "u": [1, 2]}, ", row 2: column 'time' has 'b', which is neither"),
        ({"time": [True, False], "u": [1, 2]}, ": column 'time' has neither numbers nor dates"),
        ({"time": STAMPS, "u": [1, 2]}, ": column 'time' has dates, but the time step has no unit"),
        ({"time": [], "u": []}, " has no rows"),
        ({"date": [1], "u": [1]}, " has no column 'time'; its columns are date, u: rename one"),
    ],
)
def test_tables_of_pandas_with_mistakes(monkeypatch, table, message):
    monkeypatch.setattr(pd, "read_parquet", lambda path: pd.DataFrame(table))
    for source, name in ((pd.DataFrame(table), "the table"), ("a.parquet", "a.parquet")):
        with pytest.raises(ValueError, match=f"^{re.escape(name + message)}"):
            runs(source, "u")
    doubled = pd.DataFrame([[0, 1, 2]], columns=["time", "u", "u"])
    with pytest.raises(ValueError, match="the table has 2 columns that are called 'u'"):
        runs(doubled, "u")


FLOW = xarray.Dataset(
    {
        "u": (("series", "time"), STATES[:, :, 0]),
        "v": (("time", "series"), STATES[:, :, 1].T),
        "w": ("time", np.arange(7.0)),
    },
    coords={"time": np.arange(7.0)},
)
STATE = xarray.DataArray(STATES, dims=("series", "time", "component"), name="state")


def test_variables(tmp_path):
    for source, name in zip(both(FLOW, tmp_path / "a.nc"), ("the array", tmp_path), strict=True):
        of_series = runs(source, "u", "v", "w")
        assert np.array_equal(states(of_series, "u", "v"), STATES)
        assert all(
            np.array_equal(run.columns[name], np.arange(7.0))
            for run in of_series
            for name in ("w", "time")
        )
        assert of_series[2].name.startswith(str(name))
        assert of_series[2].name.endswith(", series 3")
    (alone,) = runs(FLOW["w"], "w")
    assert alone.columns["w"].tolist() == list(range(7))


def test_components_by_their_labels(tmp_path):
    turned = STATE.transpose("time", "component", "series")
    for labels, names in (
        (["v", "u"], ["v", "u"]),
        ([b"v", b"u"], ["v", "u"]),
        ([4, 0.5], ["c4", "c0.5"]),
    ):
        for source in both(turned.assign_coords(component=labels), tmp_path / "a.nc"):
            assert content_of(source).names == names
            assert np.array_equal(states(runs(source, *names), *names), STATES)
    twice = turned.to_dataset().assign(other=turned[..., 0])
    for source in both(twice, tmp_path / "a.nc"):
        with pytest.raises(ValueError, match="has 'c1' in state and in other: keep one of them"):
            content_of(source)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (FLOW[["u"]].rename(series="rig"), r"has no variable with the dimensions series, "),
        (FLOW["u"][:, 0].drop_vars("time"), r"it has u \(series\): rename them"),
        (FLOW[["u", "v"]].assign(v=("x", [1.0])), "there is no column 'v'"),
    ],
)
def test_dimensions_of_other_names(tmp_path, data, message):
    for source in both(data, tmp_path / "a.nc"):
        with pytest.raises(ValueError, match=rf"^(the array|/.*a\.nc).*{message}"):
            content_of(source).columns_of([Quantity("u"), Quantity("v")])


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (STATES * 1j, "state must consist of real numbers, not of complex128"),
        (STATES.astype(str), "state must consist of real numbers, not of <U"),
        (STATES[:, :0], r"state is empty: its shape is \(3, 0, 2\)"),
    ],
)
def test_arrays_without_real_numbers(values, message):
    with pytest.raises((ValueError, TypeError), match=f"^the array, {message}"):
        runs(xarray.DataArray(values, dims=STATE.dims, name="state"), "c1")


def timed(units, calendar=None):
    attributes = {"units": units} | ({"calendar": calendar} if calendar else {})
    return xarray.Dataset({"u": ("time", [1.0, 2]), "time": ("time", [0.0, 60], attributes)})


@pytest.mark.parametrize(
    ("units", "calendar", "expected", "scale"),
    [
        ("hours since 2020-03-01 06:00:00", "standard", "2020-03-01 06:00", 60),
        ("minutes since 2020-3-1", "proleptic_gregorian", "2020-03-01", 1),
        ("milliseconds since 2020-03-01", "standard", "2020-03-01", 1 / 60000),
        ("days since 1970-01-01T00:00:00Z", "gregorian", "1970-01-01", 1440),
        ("days since 1970-01-01 00:00:00 UTC", "gregorian", "1970-01-01", 1440),
        ("hours since 2020-03-01 06:00 +01:00", "standard", "2020-03-01 05:00", 60),
        ("days", None, "1970-01-01", 1440),
        ("s", None, "1970-01-01", 1 / 60),
        ("Hours", None, "1970-01-01", 60),
        ("", None, "1970-01-01", 1),
    ],
)
def test_times_are_what_their_units_say(tmp_path, units, calendar, expected, scale):
    path = tmp_path / "a.nc"
    first = (pd.Timestamp(expected) - pd.Timestamp(0)) / pd.Timedelta("1min")
    for source in both(timed(units, calendar), path):
        (run,) = runs(source, "u", unit="minute")
        assert run.columns["time"].tolist() == [first, first + 60 * scale]
        # without a unit, numbers
        assert runs(source, "u")[0].columns["time"].tolist() == [0, 60]
    if calendar:
        with xarray.open_dataset(path) as decoded:
            assert runs(decoded, "u", unit="minute")[0].columns["time"][0] == first
            with pytest.raises(ValueError, match="the array: 'time' has dates, but the time step"):
                runs(decoded, "u")


@pytest.mark.parametrize(
    ("units", "calendar", "message"),
    [
        ("months since 2020-03-01", "standard", "'time' has the units 'months since 2020-03-01'"),
        ("days since 2020-03-01", "360_day", "'time' has dates of the calendar 360_day"),
        ("days since noon", "standard", "'time' has the units 'days since noon'; with a unit in"),
        ("days since 2020-03-01 06:00 CET", "standard", "'time' has the units 'days since 2020"),
        ("hours after 2000-01-01", None, "'time' has the units 'hours after 2000-01-01'"),
    ],
)
def test_times_that_are_refused(tmp_path, units, calendar, message):
    for source in both(timed(units, calendar), tmp_path / "a.nc"):
        with pytest.raises(ValueError, match=message):
            runs(source, "u", unit="minute")


@pytest.mark.parametrize("cut", [1, 8, 50])
def test_a_classic_netcdf_file_that_is_cut_off(tmp_path, cut):
    """The library of netCDF reads zeros for what is missing."""
    path = tmp_path / "a.nc"
    FLOW[["u"]].isel(series=0).to_netcdf(path, engine="netcdf4", format="NETCDF3_CLASSIC")
    assert np.array_equal(runs(path, "u")[0].columns["u"], STATES[0, :, 0])
    path.write_bytes(path.read_bytes()[:-cut])
    with pytest.raises(ValueError, match=r"a\.nc is cut off"):
        runs(path, "u")


def test_a_damaged_classic_file_is_not_opened_by_the_library_of_netcdf(tmp_path):
    """It dies of some, such as this one with a dimension of 2 ** 33 entries."""
    path = tmp_path / "a.nc"
    FLOW[["u"]].isel(series=0).to_netcdf(path, engine="netcdf4", format="NETCDF3_64BIT_DATA")
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


@pytest.mark.parametrize("suffix", ["csv", "nc"])
def test_no_content(tmp_path, suffix):
    path = tmp_path / f"a.{suffix}"
    for content in (b"", b"\x00\x01PK\xff" * 9):
        path.write_bytes(content)
        with pytest.raises(ValueError, match=rf"^[^ ]*a\.{suffix}"):
            runs(path)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("a.npy", ": files of series end in .csv, .parquet, .nc, .zarr, .h5; .*data_recipes"),
        ("a.mat", ": files of series end in"),
        ("a.csv", ": there is no such file, seen from /"),
        ("a.nc", ": there is no such file, seen from /"),
        ("a.zarr", ": there is no such file, seen from /|: reading .zarr takes the package zarr"),
        ("a.h5", ": there is no such file, seen from /|: reading .h5 takes the package h5netcdf"),
        ("a.parquet", ": there is no such file, seen from /|pyarrow is required"),
    ],
)
def test_files_that_are_none_or_missing(tmp_path, name, message):
    with pytest.raises(ValueError, match=name + message):
        runs(tmp_path / name)


@pytest.mark.parametrize(("suffix", "package"), [("zarr", "zarr"), ("h5", "h5netcdf")])
def test_what_xarray_opens_with_other_packages(tmp_path, monkeypatch, suffix, package):
    path = tmp_path / f"a.{suffix}"
    monkeypatch.setattr(xarray.backends, "list_engines", lambda: {"netcdf4": None})
    with pytest.raises(ValueError, match=f"takes the package {package}, which is not installed"):
        runs(path)
    monkeypatch.undo()
    pytest.importorskip(package)
    FLOW.to_zarr(path) if suffix == "zarr" else FLOW.to_netcdf(path, engine=package)
    assert np.array_equal(states(runs(path), "u", "v"), STATES)


def test_names_that_look_alike_are_told(tmp_path):
    """Composed and decomposed letters, of files and of columns, and blanks around names."""
    composed, decomposed = (unicodedata.normalize(form, "höhe") for form in ("NFC", "NFD"))
    path = tmp_path / f"{composed}.csv"
    path.write_text(f"time,{composed},v\n0,1,2\n", encoding="utf-8")
    with pytest.raises(ValueError, match="looks the same, but is written with other characters"):
        runs(tmp_path / f"{decomposed}.csv")
    table = pd.DataFrame({"time": [0.0, 1.0], f"{composed}": [1.0, 2.0], "u ": [1.0, 2.0]})
    for name, message in ((decomposed, "is written with other characters"), ("u", "other blanks")):
        with pytest.raises(ValueError, match=message):
            content_of(table).columns_of([Quantity(name)])


def test_what_is_no_file_is_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / "pipe.csv")
    (tmp_path / "endless.csv").symlink_to("/dev/zero")
    for name in ("pipe.csv", "endless.csv"):
        with pytest.raises(ValueError, match="is no file, but a pipe or a device, which"):
            content_of(tmp_path / name)
    for address in ("https://example.org/a.csv", "s3://lab/a.nc"):
        with pytest.raises(ValueError, match="is an address, not a file: download it first"):
            content_of(address)


def test_variables_in_groups_of_a_netcdf_file_are_told(tmp_path):
    path = tmp_path / "a.nc"
    with netCDF4.Dataset(path, "w") as file:
        file.createGroup("science")
    with pytest.raises(ValueError, match=r"has its variables in groups \(science\): open one with"):
        content_of(path)


def test_other_sources():
    with pytest.raises(TypeError, match="a DataFrame or what xarray holds, not from dict"):
        content_of({"u": [1.0]})


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
    lambda text: "########",
    lambda text: "NA",
    lambda text: "",
)
"""What happens to a number in a table."""


@settings(max_examples=150)
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
    try:
        (read,), message = states(runs(path, *names), *names), str(path)
    except ValueError as error:
        read, message = np.full_like(values, np.nan), str(error)
    assert message.startswith(str(path))
    # gaps are refused later on; a shifted row has one, and another time
    assert read.shape == values.shape
    assert np.isnan(read).any() or (damage != "shift" and np.array_equal(read, values))


@settings(max_examples=50)
@given(order=st.permutations(["series", "time", "component"]), wrong=st.sampled_from([*"0123", ""]))
def test_permuted_axes(tmp_path_factory, order, wrong):
    path = tmp_path_factory.getbasetemp() / "fuzz.nc"
    dims = {axis: f"{axis}_" for number, axis in enumerate(order) if str(number) == wrong}
    for source in both(STATE.transpose(*order).rename(dims), path):
        if dims:
            with pytest.raises(ValueError, match="has no variable with the dimensions"):
                content_of(source)
        else:
            assert np.array_equal(states(runs(source, "c1", "c2"), "c1", "c2"), STATES)
