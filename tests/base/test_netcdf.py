import math
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import netCDF4
import numpy as np
import pytest

from burstcast.base.files import atomic_files
from burstcast.base.files.described import Described
from burstcast.base.files.netcdf import (
    Variable,
    read_attributes,
    read_netcdf,
    read_record,
    read_rows,
    variables_of,
    write_netcdf,
)


def example():
    states = np.random.default_rng(3).normal(size=(7, 11, 3))
    states[2, 3, 1], states[0, 0, 0] = math.nan, math.inf  # a diverged forecast is data
    column, none = np.array([1, 2, 3], dtype=np.int32), np.zeros((0, 3))
    return {
        "states": Variable(("series", "time", "component"), states, "1", "states", (2, 4, 3)),
        "series": Variable(("series",), np.arange(7), "1", "number of the series"),
        "kept": Variable(("series",), np.arange(7) % 2 == 0, "1", "whether it is kept"),
        "column": Variable(("component",), column, "1", "column"),
        "interval": Variable((), 0.25, "s", "sampling interval"),
        "none": Variable(("events", "component"), none, "1", "nothing", (5, 3)),
    }


def test_netcdf_round_trip_is_exact(tmp_path):
    variables = example()
    write_netcdf(tmp_path / "data.nc", variables, {"seed": 3, "step": 0.1, "rule": "simuläte"})
    read = read_netcdf(tmp_path / "data.nc")
    assert list(read) == list(variables)
    for name, variable in variables.items():
        expected = np.asarray(variable.data)
        assert read[name].dtype == expected.dtype
        np.testing.assert_array_equal(read[name], expected)
    attributes = read_attributes(tmp_path / "data.nc")
    assert attributes == {"seed": 3, "step": 0.1, "rule": "simuläte"}
    assert [type(attributes[name]) for name in ("seed", "step", "rule")] == [int, float, str]


def test_netcdf_describes_itself(tmp_path):
    write_netcdf(tmp_path / "data.nc", example(), {})
    with netCDF4.Dataset(tmp_path / "data.nc") as file:
        states, series = file["states"], file["series"]
        assert (file.data_model, states.dimensions) == ("NETCDF4", ("series", "time", "component"))
        assert (states.units, states.long_name) == ("1", "states")
        assert (states.chunking(), series.chunking()) == ([2, 4, 3], "contiguous")
        # the margins of chunks hold no memory; data in one piece leave nothing to fill
        assert states.get_fill_value() is not None
        assert series.get_fill_value() is None


def test_selected_variables_and_rows(tmp_path):
    variables = example()
    write_netcdf(tmp_path / "data.nc", variables, {})
    assert list(read_netcdf(tmp_path / "data.nc", "kept", "interval")) == ["kept", "interval"]
    rows = read_rows(tmp_path / "data.nc", "states", 2, 5)
    np.testing.assert_array_equal(rows, np.asarray(variables["states"].data)[2:5])
    assert read_rows(tmp_path / "data.nc", "kept", 1, 1).shape == (0,)


def test_what_is_not_there_is_named(tmp_path):
    write_netcdf(tmp_path / "data.nc", example(), {})
    with pytest.raises(KeyError, match=r"no variable 'state'; it has states, series"):
        read_netcdf(tmp_path / "data.nc", "state")
    for start, stop in ((5, 8), (-1, 3), (3, 2)):
        with pytest.raises(IndexError, match="rows"):
            read_rows(tmp_path / "data.nc", "states", start, stop)


def test_equal_content_is_equal_bits_in_every_process_and_second(tmp_path):
    paths = [tmp_path / "first.nc", tmp_path / "below" / "second.nc"]
    paths[1].parent.mkdir()
    write_netcdf(paths[0], example(), {"a": 1, "b": "x"})
    time.sleep(1.1)
    # another process, whose memory holds other garbage where margins of chunks could pick it up
    code = (
        "import sys, numpy as np; sys.path.insert(0, sys.argv[2])\n"
        "garbage = [np.full(1000, i) for i in range(500)]; del garbage\n"
        "import test_netcdf\n"
        "test_netcdf.write_netcdf(sys.argv[1], test_netcdf.example(), {'b': 'x', 'a': 1})"
    )
    here = str(Path(__file__).parent)
    subprocess.run([sys.executable, "-c", code, str(paths[1]), here], check=True)
    assert paths[0].read_bytes() == paths[1].read_bytes()


@pytest.mark.parametrize(
    ("variables", "error", "message"),
    [
        ({"a": Variable(("x",), np.zeros((2, 3)), "1", "")}, ValueError, "a: 1 dimensions"),
        ({"a": Variable(("x",), np.zeros(2), "1", "", (1, 1))}, ValueError, "a: chunks"),
        ({"a": Variable(("x",), ["text"], "1", "")}, TypeError, "a: cannot store"),
        ({"a": Variable(("x",), [1j], "1", "")}, TypeError, "a: cannot store"),
        (
            {"a": Variable(("x",), [1.0], "1", ""), "b": Variable(("x",), [1.0, 2.0], "1", "")},
            ValueError,
            "b: dimension x has length 2, and 1",
        ),
    ],
)
def test_unfit_variables_are_refused(tmp_path, variables, error, message):
    with pytest.raises(error, match=message):
        write_netcdf(tmp_path / "data.nc", variables, {})
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("value", [True, None, [1], np.int64(2)])
def test_unfit_attributes_are_refused(tmp_path, value):
    with pytest.raises(TypeError, match="attribute seed"):
        write_netcdf(tmp_path / "data.nc", {}, {"seed": value})


def test_a_failed_write_leaves_the_old_file_and_new_ones_have_ordinary_permissions(tmp_path):
    path = tmp_path / "record.txt"
    path.write_text("old")

    def stopped():
        raise KeyboardInterrupt

    # amid the content, and by the check of what is whole
    for during, check in ((stopped, None), (lambda: None, stopped)):
        with pytest.raises(KeyboardInterrupt), atomic_files.atomic(path, check) as partial:  # noqa: PT012
            partial.write_text("half of the new")
            during()
    assert [entry.name for entry in tmp_path.iterdir()] == ["record.txt"]
    assert path.read_text() == "old"
    (tmp_path / "plain").write_text("")
    write_netcdf(tmp_path / "data.nc", example(), {})
    modes = [(tmp_path / name).stat().st_mode for name in ("plain", "data.nc")]
    assert modes[0] == modes[1]


def test_full_disk_is_an_error_and_leaves_nothing(tmp_path, monkeypatch):
    def no_space(descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(atomic_files.os, "fsync", no_space)
    with pytest.raises(OSError, match="the disk is full: make room"):
        write_netcdf(tmp_path / "data.nc", example(), {})
    assert list(tmp_path.iterdir()) == []


def test_partial_files_are_not_seen_as_finished_and_can_be_removed(tmp_path):
    path = tmp_path / "data.nc"
    with atomic_files.atomic(path) as partial:
        partial.write_text("x")
        assert not path.exists()
        killed = partial.with_name(partial.name.replace(".partial", "0.partial"))
        killed.write_text("left behind by a killed job")
    other = tmp_path / ".data.nc2.abc.partial"
    other.write_text("of another file")
    atomic_files.remove_partial(path)
    assert sorted(entry.name for entry in tmp_path.iterdir()) == [other.name, "data.nc"]


@dataclass(frozen=True)
class Seen:
    time: Annotated[np.ndarray, Described("time", "time units", "time of each step")]
    state: Annotated[np.ndarray, Described("time component", "1", "states")]
    error: Annotated[float, Described("", "1", "largest error")]


def test_a_dataclass_of_arrays_is_written_with_what_it_says_of_them(tmp_path):
    seen = Seen(np.arange(3.0), np.ones((3, 2)), 0.25)
    write_netcdf(tmp_path / "seen.nc", variables_of(seen), {})
    with netCDF4.Dataset(tmp_path / "seen.nc") as file:
        state = file["state"]
        assert (state.dimensions, state.long_name) == (("time", "component"), "states")
        assert (state.units, file["time"].units) == ("1", "time units")
    record = read_record(tmp_path / "seen.nc", Seen)
    np.testing.assert_array_equal(record.state, seen.state)
    assert record.error == 0.25
