"""What the harness writes: JSON, tables, the origin of files."""

import math

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.base.files.tables import read_table
from burstcast_workflow.harness.call import job_identity, provenance
from burstcast_workflow.harness.storage import (
    write_json,
    write_table,
)
from burstcast_workflow.tracking.environment import LIBRARIES

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


# -- settings and the origin of files --------------------------------------------------------------


def test_a_job_is_identified_by_its_rule_and_wildcards_numbers_as_numbers():
    wildcards = {"case": "1e3", "seed": "03", "forecaster": "esn", "x": "1.50", "family": "models"}
    expected = {"rule": "train", "case": "1e3", "seed": 3, "forecaster": "esn", "x": 1.5}
    assert job_identity("train", wildcards) == expected


def test_files_say_which_job_made_them_with_which_settings_and_libraries():
    origin = provenance({"rule": "train", "seed": 3}, {"b": [1, 2.0], "a": {"quantile": None}})
    assert origin["settings"] == '{"a": {"quantile": null}, "b": [1, 2]}'
    assert (origin["rule"], origin["identity"]) == ("train", '{"rule": "train", "seed": 3}')
    assert origin.keys() - {"rule", "identity", "settings"} == {"source", "python", *LIBRARIES}
