"""What the harness writes: JSON, tables, NetCDF, and the version that its forms belong to."""

import hashlib
import json
import math
from pathlib import Path

import netCDF4
import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.base.files.netcdf import Variable, read_attributes, read_netcdf, read_rows
from burstcast.base.files.tables import read_table
from burstcast_workflow.harness.job import job_identity, provenance
from burstcast_workflow.harness.settings import with_thresholds
from burstcast_workflow.harness.storage import (
    read_json,
    write_json,
    write_netcdf,
    write_table,
    write_text,
)
from burstcast_workflow.harness.version import HARNESS_VERSION

# -- JSON ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "error"),
    [(math.nan, ValueError), (math.inf, ValueError), (np.int64(1), TypeError)],
)
def test_json_refuses_what_it_cannot_say(tmp_path, value, error):
    with pytest.raises(error, match=r"record\.json"):
        write_json(tmp_path / "record.json", {"a": [value]})
    assert list(tmp_path.iterdir()) == []


# -- tables ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "table",
    [
        pd.DataFrame({"case": [], "f_score": []}),
        pd.DataFrame({"x": [np.nan, 1.5, np.nan]}),
        pd.DataFrame({"case": ["nan", "1_000", "0x1", "1", None, "1e"]}),  # only like numbers
        pd.DataFrame({"case": ["Re400"] * 50_000, "event": np.arange(50_000)}),
    ],
    ids=["no rows", "nothing in lines", "like numbers", "large"],
)
def test_write_table_and_read_table_keep_values_types_and_text(table, tmp_path):
    paths = [tmp_path / name for name in ("table.csv", "again.csv")]
    write_table(paths[0], table)
    back = read_table(paths[0])
    pd.testing.assert_frame_equal(back, table, check_dtype=len(table) > 0)  # or there are none
    write_table(paths[1], back)
    assert paths[0].read_bytes() == paths[1].read_bytes()


@given(st.lists(st.floats(allow_nan=False), min_size=1, max_size=20))
@settings(max_examples=50, deadline=None)
def test_numbers_come_back_exactly(tmp_path_factory, numbers):
    path = tmp_path_factory.mktemp("tables") / "table.csv"
    write_table(path, pd.DataFrame({"x": numbers}))
    assert read_table(path)["x"].tolist() == numbers


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"case": ["1", "2"]}, "column case would be read as"),
        ({"case": ["inf", "-inf"]}, "column case would be read as"),
        ({"case": ["True", "False"]}, "column case would be read as"),
        (pd.DataFrame([[1, 2]], columns=["a", "a"]), "share a name"),
    ],
)
def test_tables_that_would_be_misread_are_refused(tmp_path, table, message):
    with pytest.raises(ValueError, match=message):
        write_table(tmp_path / "table.csv", pd.DataFrame(table))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("text", "message"),
    [("", "it is empty"), ("a,b\n1,2\n3\n", "row 2 has another number"), ('a\n"x', "end of data")],
)
def test_a_file_that_is_no_table_is_told(tmp_path, text, message):
    (tmp_path / "table.csv").write_text(text)
    with pytest.raises(ValueError, match=f"table.csv is no table: .*{message}"):
        read_table(tmp_path / "table.csv")


# -- the version of the harness --------------------------------------------------------------------

DIGESTS = {
    3: {
        "netcdf": "4d8c1011a202fa874f6dbbb2ecd477b1d29829cf7d70145bd16c7098b6ec31c7",
        "json_and_text": "986b233532407d1d8e37deb92f62dc68ccc0a9e98c87b0185cbbe74f88ba3f6e",
        "table": "5b320b284743e941fef8c14847e7bcaf0a15dc40f88f2ec4ed4eea677eb531ec",
        "settings_and_origin": "ba5439f73655eba3a0af46f7dc5429b34a0693f938d8ea821c3833f9d3af3388",
    },
}


def netcdf() -> bytes:
    """Whatever a reader sees of a file; its bytes depend on the version of HDF5, too."""
    states = np.arange(2 * 5 * 3, dtype=float).reshape(2, 5, 3) / 7
    states[1, 2, 0], states[0, 0, 0] = np.nan, np.inf
    write_netcdf(
        "data.nc",
        {
            "state": Variable(("series", "time", "component"), states, "1", "states", (1, 4, 9)),
            "kept": Variable(("series",), np.array([True, False]), "1", "whether it is kept"),
            "series": Variable(("series",), np.array([3, 4], dtype=np.int32), "1", "number"),
            "time": Variable((), 0.1, "time units", "sampling interval"),
            "event": Variable(("event",), np.zeros(0), "1", "events"),
        },
        {"seed": 3, "rule": "simuläte", "step": 0.1},
    )
    with netCDF4.Dataset("data.nc") as file:
        file.set_auto_maskandscale(False)
        seen = [
            [name, str(data.dtype), data.endian(), data.dimensions, data.chunking(), data.filters()]
            + [[key, str(data.getncattr(key))] for key in data.ncattrs()]
            + [np.asarray(data[...]).tobytes().hex()]
            for name, data in file.variables.items()
        ]
        dimensions = [[key, len(axis), axis.isunlimited()] for key, axis in file.dimensions.items()]
        of_file = [[key, str(file.getncattr(key))] for key in file.ncattrs()]
        seen += [file.data_model, dimensions, of_file]
    arrays = {**read_netcdf("data.nc"), "rows": read_rows("data.nc", "state", 1, 2)}
    for name, array in arrays.items():
        seen.append([name, str(array.dtype), array.shape, array.tobytes().hex()])
    return json.dumps([seen, read_attributes("data.nc")]).encode()


def json_and_text() -> bytes:
    write_json("record.json", {"b": [1, 2.5, None, True], "a": {"ä": "k ≥ k_e", "third": 1 / 3}})
    write_text("record.txt", "Zeile\r\nline ≥\n")
    read = repr(read_json("record.json")).encode()
    return Path("record.json").read_bytes() + Path("record.txt").read_bytes() + read


def table() -> bytes:
    columns = {
        **{"reynolds": [400, None], "seed": pd.array([0, None], dtype="Int64")},
        **{"score": [0.1 + 0.2, np.nan], "chosen": [True, False], "note": ['a "b", c', None]},
        **{"time": [np.inf, 1e-300], "case": ["a", "b"], "events": [7, 8]},
        "nrmse_u": [np.nan, np.nan],  # a column without any value is written, and read
    }
    write_table("table.csv", pd.DataFrame(columns))
    read = read_table("table.csv")
    seen = {name: [str(read[name].dtype), *map(repr, read[name].tolist())] for name in read}
    return Path("table.csv").read_bytes() + json.dumps(seen).encode()


def settings_and_origin() -> bytes:
    threshold = {"case": "a", "quantile": 0.99}
    given = {"case": {"event_threshold": threshold, "other": [{"case": "a"}, 1.5]}}
    identity = job_identity(
        "train", {"case": "1e3", "seed": "03", "forecaster": "esn", "x": "1.50"}
    )
    origin = provenance(identity, {"b": [1, 2.0], "a": {"quantile": None}})
    # libraries and Python differ from machine to machine: their names count
    libraries = sorted(set(origin) - {"source", "rule", "identity", "settings"})
    stated = [origin[name] for name in ("rule", "identity", "settings")]
    return json.dumps([with_thresholds(given, {"a": 0.1}.get), stated, libraries]).encode()


WRITERS = (netcdf, json_and_text, table, settings_and_origin)


@pytest.mark.parametrize("write", WRITERS, ids=lambda write: write.__name__)
def test_what_is_written_belongs_to_the_version(write, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    digest = hashlib.sha256(write()).hexdigest()
    assert digest == DIGESTS[HARNESS_VERSION].get(write.__name__), (
        f"what the harness makes of fixed inputs ({write.__name__}) is not what its version "
        f"{HARNESS_VERSION} made of them: raise HARNESS_VERSION in harness/version.py, then write "
        f"this digest under the new version here"
    )
