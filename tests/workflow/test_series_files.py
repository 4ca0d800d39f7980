"""Files of measured series: one kind of file holds what another does."""

import base64
import importlib.util
import zlib

import netCDF4
import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.data.series_files import read_runs

STATES = np.random.default_rng(1).normal(size=(3, 7, 2))  # (series, time, component)
COLUMNS, LABELS = {"columns": ["u", "v"]}, {"series": "r"}
NOTHING = {
    **{"columns": [], "header": None, "series": None, "array": None, "axes": []},
    **{"time": None, "time_unit": None, "time_zone": None},
}


def runs(path, wanted=("u", "v"), **data):
    def needed(known):
        for name in wanted:
            if name not in known:
                raise ValueError(f"there is no column {name!r}; the columns are {', '.join(known)}")
        return list(wanted)

    return read_runs(str(path), {**NOTHING, **data}, needed)


def states(found, *names):
    return np.stack([np.stack([run.columns[name] for name in names], axis=1) for run in found])


def write_netcdf(path, variables, **how):
    with netCDF4.Dataset(path, "w", **how) as file:
        for name, (dimensions, data) in variables.items():
            for dimension, length in zip(dimensions, np.shape(data), strict=True):
                if dimension not in file.dimensions:
                    file.createDimension(dimension, length)
            file.createVariable(name, "f8", dimensions)[...] = data


def test_csv_with_a_header_to_the_last_digit(tmp_path) -> None:
    path = tmp_path / "a.csv"
    table = pd.DataFrame(STATES[0], columns=["u", "v"]).assign(note="text")
    table.to_csv(path, index=False, float_format="%.17g")
    (found,) = runs(path)
    assert found.name == str(path)
    assert np.array_equal(states([found], "u", "v")[0], STATES[0])


@pytest.mark.parametrize(("suffix", "separator"), [("csv", ","), ("tsv", "\t"), ("txt", "   ")])
def test_nothing_but_numbers(tmp_path, suffix, separator) -> None:
    path = tmp_path / f"a.{suffix}"
    np.savetxt(path, STATES[0], delimiter=separator, fmt="%.17g", header="a comment")
    assert np.array_equal(states(runs(path, columns=["u", "v"]), "u", "v")[0], STATES[0])
    unnamed = runs(path, ("column_1", "column_2"))
    assert np.array_equal(states(unnamed, "column_1", "column_2")[0], STATES[0])


def test_a_table_of_several_series_in_the_order_of_the_file(tmp_path) -> None:
    path = tmp_path / "a.csv"
    # names that would be sorted otherwise
    parts = [pd.DataFrame(STATES[i], columns=["u", "v"]).assign(run=f"r{9 + i}") for i in range(3)]
    pd.concat(parts).to_csv(path, index=False, float_format="%.17g")
    found = runs(path, series="run")
    assert np.array_equal(states(found, "u", "v"), STATES)
    assert [run.name for run in found] == [f"{path}, run r{number}" for number in (9, 10, 11)]
    pd.concat(parts).sort_index(kind="stable").to_csv(path, index=False, float_format="%.17g")
    assert np.array_equal(states(runs(path, series="run", time="t"), "u", "v"), STATES)
    with pytest.raises(ValueError, match=r"line 5: the label 'r9' .* again after 'r11'.*data.time"):
        runs(path, series="run")
    with pytest.raises(ValueError, match=r"has no column 'runs' .did you mean 'run'.*data.series"):
        runs(path, series="runs")


def test_gaps_are_nan_and_text_is_refused(tmp_path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("u,v\n1,2\n,4\nnan,6\n")
    (found,) = runs(path)
    assert np.array_equal(found.columns["u"], [1, np.nan, np.nan], equal_nan=True)
    path.write_text("u,v\n1,2\n3,4\nerror,6\n")
    with pytest.raises(
        ValueError, match=r"a\.csv, line 4: column 'u' has 'error', which is no num"
    ):
        runs(path)


@pytest.mark.parametrize(
    ("text", "data", "message"),
    [
        ("", {}, r"a\.csv is empty"),
        ("# u\n\n", {}, r"a\.csv is empty"),
        ("u,v\n", {}, r"a\.csv has a header, but no rows"),
        ("µ,u,v\n1,2,3\n".encode("latin-1"), {}, r"a\.csv is not written in UTF-8"),
        ("u,v\n1,2\n".encode("utf-16"), {}, r"a\.csv is not written in UTF-8"),
        ("1,2\n3.5,4\n5,6\n", {"columns": ["u"]}, "1, 2 are the names of columns or the first"),
        ("1.,2\n3,4\n", {"columns": ["u"]}, "has 2 columns, but data.columns names 1"),
        ("a,b\n3,4\n", {"columns": ["u", "v"]}, "has a header in line 1, a, b: leave out data.col"),
        ("u,w\n3,4\n", {}, r"a\.csv: there is no column 'v'; the columns are u, w"),
        ("u,v,u\n1,2,3\n", {}, r"a\.csv has 2 columns that are called 'u'"),
        # more fields or fewer: a third value, decimal commas, thousands, a trailing comma, a gap
        ("# x\nu,v\n1,2\n3,4,5\n", {}, r"a\.csv, line 4 has 3 fields, but line 2 has 2"),
        ("u,v\n1,5,2,5\n", {}, r"a\.csv, line 2 has 4 fields, but line 1 has 2"),
        ("u,v\n1,2\n1,000,2\n", {}, r"a\.csv, line 3 has 3 fields, but line 1 has 2"),
        ("u,v\n1,2,\n3,4,\n", {}, r"a\.csv, line 2 has 3 fields, but line 1 has 2"),
        ("u,v\n1,2\n3\n", {}, r"a\.csv, line 3 has 1 fields, but line 1 has 2"),
        ("u,v\n1,10#15\n", {}, r"a\.csv, line 2: column 'v' has '10#15', which is no number"),
        ("u,v\n1,1_0\n", {}, r"a\.csv, line 2: column 'v' has '1_0', which is no number"),
        ('u,v,note\n1,2,"\n3,4,"\n5,6,\n', {}, r"a\.csv, line 2: unexpected end of data"),
        # rows that have moved in a spreadsheet, whose last column nobody asks for
        (
            "u,v,w\n1,2,3\n5,6,\n",
            {},
            r"line 3: the last field is empty, that of the first sample n",
        ),
        (
            "u,v,w,\n1,2,3,\n5,6,,\n",
            {},
            r"line 3: the last field is empty, that of the first sample ",
        ),
        ("1.,2,2\n5,6,\n", {"columns": ["u", "v", "w"]}, r"line 2: the last field is empty"),
        ("u,v,w\n2,3,\n4,5,6\n", {}, r"line 3: the last field is number, that of .* sample empty"),
        ("u,v,w,\n1,2,3,\n4,,5,6\n", {}, r"line 3 has \['6'\] beyond the last column .* 'w' in"),
        ("u,v\n########,2\n3,4\n", {}, r"a\.csv, line 2: column 'u' has '########'"),
        ("u,v\n1,2\n#WERT!,4\n", {}, r"a\.csv, line 3: column 'u' has '#WERT!'"),
        # runs, one after the other
        ("u,v\n1,2\n\n3,4\n", {}, r"a\.csv, line 3 is blank or a comment between rows"),
        ("1.,2\n#N/A,3\n# run 2\n3,4\n", COLUMNS, r"line 3 is blank or a comment between rows"),
        ("r,u,v\na,1,2\nb,3,4\na,5,6\n", LABELS, r"line 4: the label 'a' of 'r' comes again after"),
        ("r,u,v\n1,1,2\n1.0,3,4\n", LABELS, "'r' has the labels '1' and '1.0', which are the same"),
        ("r,u,v\na,1,2\n,3,4\n", LABELS, r"a\.csv, line 3 has no label in column 'r'"),
    ],
)
def test_tables_with_mistakes(tmp_path, text, data, message) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(ValueError, match=message):
        runs(path, **data)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("flow rate v\n1 2\n", r"line 2 has 2 fields, but line 1 has 3"),
        ("u v\n######## 2\n3 4\n", r"line 2: column 'u' has '########'"),
        ("u v\n1\N{NO-BREAK SPACE}234\n", r"line 2 has 1 fields, but line 1 has 2"),
        ("u v\n1\f234 5\n", r"line 2: column 'u' has '1\\x0c234', which is no number"),
        ("u v\n1\t\t2\n", r"line 2: a field between tabs is empty: such a file ends in \.tsv"),
    ],
)
def test_texts_with_mistakes(tmp_path, text, message) -> None:
    path = tmp_path / "a.txt"
    path.write_text(text)
    with pytest.raises(ValueError, match=message):
        runs(path)


@pytest.mark.parametrize(
    "names", ["0,1", "1,2", "0,1,2", ",0,1", "2001,2002,2003", "0.0,0.25,0.5", "7,3"]
)
def test_numbers_that_may_be_names(tmp_path, names) -> None:
    """The first row is a sample or the header of pandas.DataFrame(x).to_csv."""
    path = tmp_path / "a.csv"
    samples = np.random.default_rng(2).normal(size=(4, names.count(",") + 1))
    rows = "".join(",".join(map(repr, row)) + "\n" for row in samples.tolist())
    path.write_text(f"{names}\n{rows}")
    columns = [f"c{number}" for number in range(samples.shape[1])]
    for how in ({}, {"columns": columns}):
        with pytest.raises(ValueError, match=r"a\.csv, line 1: .* say which \(data\.header"):
            runs(path, columns, **how)
    (found,) = runs(path, names.split(","), header=True)
    assert np.array_equal(states([found], *names.split(","))[0], samples)
    found = runs(path, columns, header=True, columns=columns)
    assert np.array_equal(states(found, *columns)[0], samples)
    found = runs(path, columns, header=False, columns=columns)
    assert np.array_equal(states(found, *columns)[0, 1:], samples)
    path.write_text(f"{names}\n{rows}{names}\n{rows}")
    with pytest.raises(ValueError, match=r"a\.csv, line 6 has the header of line 1 again"):
        runs(path, names.split(","), header=True)


@pytest.mark.parametrize("names", ["0,1", "1,2"])
def test_whole_numbers_below_numbers_that_may_be_names(tmp_path, names) -> None:
    path = tmp_path / "a.csv"
    path.write_text(f"{names}\n5,3\n2,7\n")
    with pytest.raises(ValueError, match=r"a\.csv, line 1: .* say which \(data\.header"):
        runs(path, **COLUMNS)


@pytest.mark.parametrize(
    "rows",
    [
        "1.0e0,2.0e0\n3,4\n",
        "5,3\n2,1\n",
        "5,6\n3,4\n",
        "0,2\n3,4\n",
        "1,1\n2.5,0\n",
        "-1,2\n3.5,4\n",
    ],
)
def test_numbers_that_are_no_names(tmp_path, rows) -> None:
    path = tmp_path / "a.csv"
    path.write_text(rows)
    assert np.array_equal(
        states(runs(path, **COLUMNS), "u", "v")[0], np.loadtxt(path, delimiter=",")
    )


@pytest.mark.parametrize(
    "text",
    [
        "\ufeff# c\n\nu,v\n\n1.5,2\n3,-4e1\n\n# end\n",
        '"u", v\n"1.5", 2\n 3 ,-4e1',
        "v,u\r\n2,1.5\r\n-40,3\r\n",
        'v,n,u,\n2,#1,1.5,\n-40,"x, y",3,\n',
        "u,v,n\n1.5,2,x\n3,-40,\n",
        "u,v,w\n1.5,2,1\n3,-40,nan\n",
        "u,v,n\n1.5,2,\n3,-40,x\n",
        "### runs of May\n#! all of them\nu,v\n1.5,2\n3,-40\n",
    ],
)
def test_dialects_of_csv(tmp_path, text) -> None:
    path = tmp_path / "a.csv"
    path.write_text(text, encoding="utf-8", newline="")
    assert np.array_equal(states(runs(path), "u", "v")[0], [[1.5, 2], [3, -40]])


@pytest.mark.parametrize("suffix", ["nc", "h5"])
def test_variables_of_netcdf(tmp_path, suffix) -> None:
    path = tmp_path / f"a.{suffix}"
    flow = {"u": (("series", "time"), STATES[:, :, 0]), "v": (("series", "time"), STATES[:, :, 1])}
    write_netcdf(path, {**flow, "t": (("time",), np.arange(7.0))})
    found = runs(path, ("u", "v", "t"))
    assert np.array_equal(states(found, "u", "v"), STATES)
    assert all(np.array_equal(run.columns["t"], np.arange(7.0)) for run in found)
    assert [run.name for run in found] == [f"{path}, series {number}" for number in (1, 2, 3)]
    for count, name in ((1, f"{path}"), (2, f"{path}, series 1")):
        write_netcdf(path, {"u": (("series", "time"), STATES[:count, :, 0])})
        assert runs(path, ["u"])[0].name == name


def test_dimensions_by_their_names_or_as_they_are_said(tmp_path) -> None:
    path = tmp_path / "a.nc"
    named = ("time", "component", "series")
    write_netcdf(path, {"state": (named, STATES.transpose(1, 2, 0))})
    how = {"array": "state", "columns": ["u", "v"]}
    assert np.array_equal(states(runs(path, **how), "u", "v"), STATES)
    write_netcdf(path, {"state": (("x", "y", "z"), STATES.transpose(1, 2, 0))})
    found = runs(path, **how, axes=["time", "component", "series"])
    assert np.array_equal(states(found, "u", "v"), STATES)
    with pytest.raises(ValueError, match=r"3 axes of lengths \(7, 2, 3\).*data\.axes"):
        runs(path, **how, axes=["time", "component"])


@pytest.mark.parametrize(
    "names", [("time", "run"), ("t", "realisation"), ("Time", "member"), ("step", "series")]
)
def test_dimensions_that_mean_the_same(tmp_path, names) -> None:
    path = tmp_path / "a.nc"
    write_netcdf(path, {"u": (names, STATES[:, :, 0].T)})
    assert np.array_equal(states(runs(path, ["u"]), "u")[:, :, 0], STATES[:, :, 0])


@pytest.mark.parametrize(
    ("dimensions", "axes", "message"),
    [
        (("time", "rig"), [], ", named time, rig, and nothing says which is which.*data.axes"),
        (("a", "b"), [], ", named a, b, and nothing says which is which.*data.axes"),
        (("time", "component"), [], r".*it holds several columns \(data.array\)"),
        (("series", "component"), [], r".*it takes series and component \(data.axes\)"),
        (("time", "series"), ["series", "time"], ".*but data.axes calls them series, time"),
    ],
)
def test_axes_that_are_not_known(tmp_path, dimensions, axes, message) -> None:
    path = tmp_path / "a.nc"
    write_netcdf(path, {"u": (dimensions, STATES[:, :, 0])})
    with pytest.raises(ValueError, match=rf"a\.nc, u has 2 axes of lengths \(3, 7\){message}"):
        runs(path, ("u",), axes=axes)


def test_one_array_by_its_axes_or_the_number_of_its_columns(tmp_path) -> None:
    path = tmp_path / "a.npy"
    np.save(path, STATES[0])
    assert np.array_equal(states(runs(path, **COLUMNS), "u", "v")[0], STATES[0])
    for data, how in ((STATES[0].T, COLUMNS), (STATES[0], {}), (STATES[0, :2], COLUMNS)):
        np.save(path, data)
        with pytest.raises(ValueError, match=r"a\.npy, array has 2 axes .*nothing says which"):
            runs(path, ("u", "v"), **how)
    np.save(path, STATES[0].T)
    found = runs(path, **COLUMNS, axes=["component", "time"])
    assert np.array_equal(states(found, "u", "v")[0], STATES[0])


def test_a_file_of_several_arrays_in_a_row(tmp_path) -> None:
    path = tmp_path / "a.npy"
    with path.open("wb") as file:
        for run in STATES:
            np.save(file, run)
    with pytest.raises(ValueError, match=r"a\.npy cannot be read: it has more after its first arr"):
        runs(path, **COLUMNS)


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (np.full((2, 3), 1j), "must consist of real numbers, not of complex128"),
        (np.full((2, 3), "1.5"), "must consist of real numbers, not of <U3"),
        (np.full((2, 3), None), "cannot be read: Object arrays"),
        (np.zeros((2, 3), [("u", float)]), r"must consist of real numbers, not of \[\('u'"),
        (np.zeros((0, 2)), "is empty"),
    ],
)
@pytest.mark.parametrize("suffix", ["npy", "npz"])
def test_arrays_without_real_numbers(tmp_path, array, message, suffix) -> None:
    path = tmp_path / f"a.{suffix}"
    np.save(path, array) if suffix == "npy" else np.savez(path, array=array)
    with pytest.raises(ValueError, match=rf"^[^ ]*a\.{suffix}.*{message}"):
        runs(path, array="array", axes=["time", "component"])


@pytest.mark.parametrize("suffix", ["csv", "txt", "npy", "npz", "nc", "h5"])
def test_no_content(tmp_path, suffix) -> None:
    path = tmp_path / f"a.{suffix}"
    for content in (b"", b"\x00\x01PK\xff" * 9):
        path.write_bytes(content)
        with pytest.raises(ValueError, match=rf"^[^ ]*a\.{suffix}"):
            runs(path)


@pytest.mark.parametrize("cut", [1, 8, 50])
def test_a_classic_netcdf_file_that_is_cut_off(tmp_path, cut) -> None:
    """The library of netCDF reads zeros for what is missing."""
    path = tmp_path / "a.nc"
    write_netcdf(path, {"u": (("time",), STATES[0, :, 0])}, format="NETCDF3_CLASSIC")
    assert np.array_equal(runs(path, ["u"])[0].columns["u"], STATES[0, :, 0])
    path.write_bytes(path.read_bytes()[:-cut])
    with pytest.raises(ValueError, match=r"a\.nc is cut off"):
        runs(path, ["u"])


def test_a_damaged_classic_file_is_not_opened_by_the_library_of_netcdf(tmp_path) -> None:
    """It dies of some, such as this one with a dimension of 2 ** 33 entries."""
    path = tmp_path / "a.nc"
    write_netcdf(path, {"u": (("time",), STATES[0, :, 0])}, format="NETCDF3_64BIT_DATA")
    content = bytearray(path.read_bytes())
    content[content.index(b"time") + 7] ^= 2
    path.write_bytes(content)
    with pytest.MonkeyPatch.context() as patch:
        patch.delattr(netCDF4, "Dataset")
        with pytest.raises(ValueError, match=r"a\.nc is cut off, or is no classic NetCDF file"):
            runs(path, ["u"])


def test_one_series_in_an_array_and_groups(tmp_path) -> None:
    path = tmp_path / "a.nc"
    with netCDF4.Dataset(path, "w") as file:
        group = file.createGroup("lab")
        group.createDimension("n", 7)
        group.createVariable("u", "f4", ("n",), fill_value=-1.0)[...] = np.arange(7) - 1.0
    (found,) = runs(path, ("lab/u",))
    expected = [np.nan, *range(6)]  # what is declared as missing is a gap
    assert np.array_equal(found.columns["lab/u"], expected, equal_nan=True)


def test_arrays_of_numpy(tmp_path) -> None:
    axes = ["series", "time", "component"]
    np.save(tmp_path / "a.npy", STATES)
    found = runs(tmp_path / "a.npy", **COLUMNS, axes=axes)
    assert np.array_equal(states(found, "u", "v"), STATES)
    # what nobody asks for may be anything
    np.savez(tmp_path / "a.npz", u=STATES[:, :, 0], v=STATES[:, :, 1], note=np.array([None]))
    assert np.array_equal(states(runs(tmp_path / "a.npz", axes=axes), "u", "v"), STATES)
    np.savez(tmp_path / "b.npz", u=STATES[0, :, 0], v=STATES[0, :3, 1])
    with pytest.raises(ValueError, match=r"v and u have the shapes \(1, 3\) and \(1, 7\)"):
        runs(tmp_path / "b.npz")
    np.savez(tmp_path / "b.npz", u=STATES[:, :, 0], v=STATES[:1, :, 1])
    with pytest.raises(ValueError, match=r"v and u have the shapes \(1, 7\) and \(3, 7\)"):
        runs(tmp_path / "b.npz", axes=["series", "time"])


def test_parquet_or_a_message(tmp_path) -> None:
    path = tmp_path / "a.parquet"
    if importlib.util.find_spec("pyarrow") is None:
        path.write_bytes(b"PAR1")
        with pytest.raises(ValueError, match="takes pyarrow, which is not installed"):
            runs(path)
        return
    pd.DataFrame(STATES[0], columns=["u", "v"]).to_parquet(path)
    assert np.array_equal(states(runs(path), "u", "v")[0], STATES[0])


@pytest.mark.parametrize(
    ("table", "data", "message"),
    [
        ({"u": [1, None], "v": [2, 3.0]}, {}, None),
        ({"r": ["a", "b"], "u": [1, 2], "v": [3, 4.5]}, LABELS, None),
        ({"u": ["1", "2"], "v": [3, 4.5]}, {}, "column 'u' has no numbers, but"),
        (
            {"u": pd.to_datetime([1, 2]), "v": [3, 4.5]},
            {},
            r"column 'u' has no numbers, but datetime",
        ),
        ({"u": [], "v": []}, {}, "has no rows"),
        ({"r": ["a", "b", "a"], "u": [1, 2, 3], "v": [3, 4, 5]}, LABELS, "comes again after 'b'"),
        ({"r": ["a", None], "u": [1, 2], "v": [3, 4]}, LABELS, "has no label in column 'r'"),
    ],
)
def test_columns_of_parquet(tmp_path, monkeypatch, table, data, message) -> None:
    monkeypatch.setattr(pd, "read_parquet", lambda path: pd.DataFrame(table))
    path = tmp_path / "a.parquet"
    if message is not None:
        with pytest.raises(ValueError, match=rf"a\.parquet.*{message}"):
            runs(path, **data)
        return
    found = np.concatenate(states(runs(path, **data), "u", "v"))
    expected = pd.DataFrame(table)[["u", "v"]].astype(float)
    assert np.array_equal(found, expected, equal_nan=True)


def test_hdf5_of_others(tmp_path) -> None:
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file["deep/state"] = STATES
    found = runs(path, array="deep/state", **COLUMNS, axes=["series", "time", "component"])
    assert np.array_equal(states(found, "u", "v"), STATES)


HALF_PRECISION = (
    "c-rgqaB<`1lHy|K;9!7(|4_gJ6*7Q|$7$+y_<OhnF)>sy2_Y+l0WKy6Mg|5p9tI%ASh^Wzo(BWfK<7P?60j417BGr1FfcJ"
    "PGBQEsU^KG`1EZh<Ka?-Pz{SeI#Sdh$0$s<<#Q}6VGb01kYb-E>H!uu2u-&iVI>RU!1*2dTjDk@>7O-Kk0RY}LCE5"
)
"""An HDF5 file with two numbers of 16 bits, u."""


def test_numbers_that_netcdf_has_not(tmp_path) -> None:
    """The library of NetCDF dies when it reads them."""
    path = tmp_path / "a.h5"
    path.write_bytes(zlib.decompress(base64.b85decode(HALF_PRECISION)))
    with pytest.raises(ValueError, match=r"a\.h5, u is text, or .* such as float16"):
        runs(path, ["u"])


def test_other_files(tmp_path) -> None:
    with pytest.raises(ValueError, match=r"a\.mat: files of series end in \.csv"):
        runs(tmp_path / "a.mat")
    with pytest.raises(ValueError, match=r"a\.nc cannot be read"):
        runs(tmp_path / "a.nc")


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


def same_or_refused(path, expected, names, data) -> None:
    """Exactly the array, or a message that begins with the file; gaps are refused later on."""
    try:
        found, message = states(runs(path, names, **data), *names), str(path)
    except ValueError as error:
        found, message = expected, str(error)
    assert message.startswith(str(path))
    assert found.shape == expected.shape
    assert np.isnan(found).any() or np.array_equal(found, expected)


@settings(max_examples=200, deadline=None)
@given(data=st.data())
def test_damaged_tables(tmp_path_factory, data) -> None:
    draw, pick = data.draw, lambda *choices: data.draw(st.sampled_from(choices))
    path = tmp_path_factory.getbasetemp() / f"fuzz.{pick('csv', 'tsv', 'txt')}"
    separator = {".csv": ",", ".tsv": "\t"}.get(path.suffix) or pick(" ", "\t", "   ")
    names, labelled = (
        pick(["u", "v"], ["v", "µ", "u"], ["0", "1"], ["2.5", "1"]),
        draw(st.booleans()),
    )
    values = np.random.default_rng(draw(st.integers(0, 99))).normal(size=(3, 4, len(names)))
    values = np.round(values, pick(0, 1, 17))[: 3 if labelled else 1]
    table = [
        [*(f"{value:{pick('.17g', '.17e')}}" for value in row), *([label] if labelled else [])]
        for label, run in zip(pick("abc", "123"), values, strict=False)
        for row in run
    ]
    header = pick(None, True)
    said = {"header": header, "series": "run" if labelled else None}
    if names[0] in "uv" and draw(st.booleans()):  # without a header
        said |= {"columns": [*names, *["run"] * labelled], "header": pick(None, False)}
    else:
        if header is None and names[0] == "2.5" and not labelled:
            return  # nothing tells these names from a sample
        table.insert(0, [*names, *["run"] * labelled])
    row = draw(st.integers(len(table) - 4, len(table) - 1))
    damage = pick("no", "cell", "more", "fewer", "shift", "last", "row")
    if damage == "cell":
        table[row][0] = pick(*CELLS)(table[row][0])
    elif damage != "no":
        old = table[row]
        table[row] = {
            "more": [*old[:1], *old], "fewer": old[1:], "shift": [*old[1:], ""],
            "last": [*old, ""], "row": [pick("", "# run 2", "u")],
        }[damage]  # fmt: skip
        table[row + 1 :] = [old] * (damage == "row") + table[row + 1 :]
    text = (
        pick("", "\ufeff", "# lab\n\n") + "\n".join(map(separator.join, table)) + pick("", "\n\n")
    )
    path.write_text(text, encoding="utf-8", newline=pick("\n", "\r\n", "\r"))
    same_or_refused(path, values, names, said)


@settings(max_examples=200, deadline=None)
@given(data=st.data())
def test_permuted_axes(tmp_path_factory, data) -> None:
    draw, pick = data.draw, lambda *choices: data.draw(st.sampled_from(choices))
    path = tmp_path_factory.getbasetemp() / f"fuzz.{pick('npy', 'npz', 'nc')}"
    expected = np.random.default_rng(0).normal(size=draw(st.tuples(*[st.integers(1, 3)] * 3)))
    axes = ["time", "component", *["series"] * (len(expected) > 1 or draw(st.booleans()))]
    order = draw(st.permutations(axes))
    full = expected if "series" in axes else expected[0]
    usual = [axis for axis in ("series", "time", "component") if axis in axes]
    array = full.transpose([usual.index(axis) for axis in order])
    if path.suffix == ".nc":
        write_netcdf(path, {"state": ([pick(axis, f"{axis}_") for axis in order], array)})
    else:
        np.save(path, array) if path.suffix == ".npy" else np.savez(path, state=array)
    names = [f"column_{number + 1}" for number in range(expected.shape[2])]
    said = {"columns": pick([], names), "axes": pick([], order), "array": "state"}
    same_or_refused(path, expected, names, said)


DATES = {"time": "t", "time_unit": "hour"}


def test_dates_in_a_column_of_times(tmp_path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("t,u\n1970-01-01,1\n1970-01-01T12:30,2\n1970-01-02 00:00:00,3\n")
    (found,) = runs(path, ("t", "u"), **DATES)
    assert found.columns["t"].tolist() == [0, 12.5, 24]
    (found,) = runs(path, ("t", "u"), **DATES, time_zone="Europe/Berlin")
    assert found.columns["t"].tolist() == [-1, 11.5, 23]
    # as text they are told what they are
    with pytest.raises(ValueError, match=r"line 2: column 't' has '1970-01-01', .*data.time_unit"):
        runs(path, ("t", "u"), time="t")
    with pytest.raises(
        ValueError, match=r"line 2: column 't' has '1970-01-01', which is no number"
    ):
        runs(path, ("t", "u"))
    path.write_text("t,u\n1970-01-01,1\n,2\n")
    with pytest.raises(ValueError, match=r"a.csv, line 3: column 't' has no time"):
        runs(path, ("t", "u"), **DATES)
    path.write_text("t,u\n1970-01-01,1\n1970-01-01T02:00Z,2\n")
    with pytest.raises(
        ValueError, match=r"line 3: column 't' has '1970-01-01T02:00Z', which is a d"
    ):
        runs(path, ("t", "u"), **DATES)


def test_dates_in_parquet(monkeypatch) -> None:
    stamps = pd.Series(pd.to_datetime(["1970-01-01 00:00", "1970-01-01 12:30"]))
    table = pd.DataFrame({"t": stamps, "u": [1.0, 2.0]})
    monkeypatch.setattr(pd, "read_parquet", lambda path: table)  # of whatever library
    (found,) = runs("a.parquet", ("t", "u"), **DATES)
    assert found.columns["t"].tolist() == [0, 12.5]
    table["t"] = stamps.dt.tz_localize("Europe/Berlin")
    (found,) = runs("a.parquet", ("t", "u"), **DATES)
    assert found.columns["t"].tolist() == [-1, 11.5]
    table.loc[1, "t"] = pd.NaT
    with pytest.raises(ValueError, match=r"a.parquet, row 2: column 't' has no time"):
        runs("a.parquet", ("t", "u"), **DATES)
