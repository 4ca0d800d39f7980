"""Files of measured series: one kind of file holds what another does."""

import importlib.util

import netCDF4
import numpy as np
import pandas as pd
import pytest

from burstcast_workflow.jobs.series_files import read_runs

STATES = np.random.default_rng(1).normal(size=(3, 7, 2))  # (series, time, component)
NOTHING = {"columns": [], "series": None, "array": None, "axes": []}


def runs(path, wanted=("u", "v"), **data):
    def needed(known):
        for name in wanted:
            if name not in known:
                raise ValueError(f"there is no column {name!r}; the columns are {', '.join(known)}")
        return list(wanted)

    return read_runs(str(path), {**NOTHING, **data}, needed)


def states(found, *names):
    return np.stack([np.stack([run.columns[name] for name in names], axis=1) for run in found])


def write_netcdf(path, variables):
    with netCDF4.Dataset(path, "w") as file:
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
    assert np.array_equal(states(runs(path, series="run"), "u", "v"), STATES)
    with pytest.raises(ValueError, match=r"has no column 'runs' .did you mean 'run'.*data.series"):
        runs(path, series="runs")


def test_gaps_are_nan_and_text_is_refused(tmp_path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("u,v\n1,2\n,4\nnan,6\n")
    (found,) = runs(path)
    assert np.array_equal(found.columns["u"], [1, np.nan, np.nan], equal_nan=True)
    path.write_text("u,v\n1,2\n3,4\nerror,6\n")
    with pytest.raises(ValueError, match=r"a\.csv: column 'u' has 'error' in row 3"):
        runs(path)


@pytest.mark.parametrize(
    ("text", "data", "message"),
    [
        ("", {}, "is no table of numbers"),
        ("u,v\n1,2\n3,4,5\n", {}, "is no table of numbers"),
        ("1,2\n3,4\n", {"columns": ["u"]}, "has 2 columns, but data.columns names 1"),
        ("a,b\n3,4\n", {"columns": ["u", "v"]}, "has a header, a, b: leave out data.columns"),
        ("u,w\n3,4\n", {}, r"a\.csv: there is no column 'v'; the columns are u, w"),
    ],
)
def test_tables_with_mistakes(tmp_path, text, data, message) -> None:
    path = tmp_path / "a.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match=message):
        runs(path, **data)


@pytest.mark.parametrize("suffix", ["nc", "h5"])
def test_variables_of_netcdf(tmp_path, suffix) -> None:
    path = tmp_path / f"a.{suffix}"
    flow = {"u": (("series", "time"), STATES[:, :, 0]), "v": (("series", "time"), STATES[:, :, 1])}
    write_netcdf(path, {**flow, "t": (("time",), np.arange(7.0))})
    found = runs(path, ("u", "v", "t"))
    assert np.array_equal(states(found, "u", "v"), STATES)
    assert all(np.array_equal(run.columns["t"], np.arange(7.0)) for run in found)
    assert found[2].name == f"{path}, series 3"


def test_dimensions_by_their_names_or_as_they_are_said(tmp_path) -> None:
    path = tmp_path / "a.nc"
    named = ("time", "component", "series")
    write_netcdf(path, {"state": (named, STATES.transpose(1, 2, 0))})
    how = {"array": "state", "columns": ["u", "v"]}
    assert np.array_equal(states(runs(path, **how), "u", "v"), STATES)
    write_netcdf(path, {"state": (("x", "y", "z"), STATES.transpose(1, 2, 0))})
    found = runs(path, **how, axes=["time", "component", "series"])
    assert np.array_equal(states(found, "u", "v"), STATES)
    with pytest.raises(ValueError, match=r"has 7 columns|has 3 columns|data.columns names 2"):
        runs(path, **how)
    with pytest.raises(ValueError, match=r"3 axes of lengths \(7, 2, 3\).*data\.axes"):
        runs(path, **how, axes=["time", "component"])


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
    np.save(tmp_path / "a.npy", STATES)
    assert np.array_equal(states(runs(tmp_path / "a.npy", columns=["u", "v"]), "u", "v"), STATES)
    np.savez(tmp_path / "a.npz", u=STATES[:, :, 0], v=STATES[:, :, 1])
    assert np.array_equal(states(runs(tmp_path / "a.npz"), "u", "v"), STATES)
    np.savez(tmp_path / "b.npz", u=STATES[0, :, 0], v=STATES[0, :3, 1])
    with pytest.raises(ValueError, match=r"v and u have the shapes \(1, 3\) and \(1, 7\)"):
        runs(tmp_path / "b.npz")


def test_parquet_or_a_message(tmp_path) -> None:
    path = tmp_path / "a.parquet"
    if importlib.util.find_spec("pyarrow") is None:
        path.write_bytes(b"PAR1")
        with pytest.raises(ValueError, match="takes pyarrow, which is not installed"):
            runs(path)
        return
    pd.DataFrame(STATES[0], columns=["u", "v"]).to_parquet(path)
    assert np.array_equal(states(runs(path), "u", "v")[0], STATES[0])


def test_hdf5_of_others(tmp_path) -> None:
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file["deep/state"] = STATES
    found = runs(path, array="deep/state", columns=["u", "v"])
    assert np.array_equal(states(found, "u", "v"), STATES)


def test_other_files(tmp_path) -> None:
    with pytest.raises(ValueError, match=r"a\.mat: files of series end in \.csv"):
        runs(tmp_path / "a.mat")
    with pytest.raises(ValueError, match=r"a\.nc cannot be read"):
        runs(tmp_path / "a.nc")
