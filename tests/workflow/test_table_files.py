import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from burstcast.files.tables import read_table
from burstcast_workflow.harness.storage import write_table


def example() -> pd.DataFrame:
    return pd.DataFrame(
        {
            "case": ["Re400", "NA", None],
            "reynolds": pd.array([400, None, 600], dtype="Int64"),
            "neurons": [500, 1000, 2000],
            "f_score": [0.1 + 0.2, np.nan, 1e-300],
            "mean": [1.0, 2.0, np.inf],
            "nothing": [np.nan, np.nan, np.nan],
            "chosen": [True, False, True],
            "note": ['a "quoted", text', "two\nlines", "ä"],
        }
    )


def test_text_of_the_file(tmp_path):
    write_table(tmp_path / "table.csv", example().drop(columns="note"))
    assert (tmp_path / "table.csv").read_bytes() == (
        b"case,reynolds,neurons,f_score,mean,nothing,chosen\n"
        b"Re400,400,500,0.30000000000000004,1.0,,True\n"
        b"NA,,1000,,2.0,,False\n"
        b",600,2000,1e-300,inf,,True\n"
    )


def test_round_trip_of_values_types_and_text(tmp_path):
    write_table(tmp_path / "table.csv", example())
    table = read_table(tmp_path / "table.csv")
    pd.testing.assert_frame_equal(table, example())
    assert table["reynolds"].dtype == "Int64"
    write_table(tmp_path / "again.csv", table)
    assert (tmp_path / "again.csv").read_bytes() == (tmp_path / "table.csv").read_bytes()


@given(st.lists(st.floats(allow_nan=False), min_size=1, max_size=20))
@settings(max_examples=50, deadline=None)
def test_numbers_come_back_exactly(tmp_path_factory, numbers):
    path = tmp_path_factory.mktemp("tables") / "table.csv"
    write_table(path, pd.DataFrame({"x": numbers}))
    assert read_table(path)["x"].tolist() == numbers


def test_table_without_rows_keeps_its_columns(tmp_path):
    write_table(tmp_path / "table.csv", example().iloc[:0])
    table = read_table(tmp_path / "table.csv")
    assert list(table.columns) == list(example().columns)
    assert len(table) == 0


def test_column_of_nothing_alone_keeps_its_rows(tmp_path):
    write_table(tmp_path / "table.csv", pd.DataFrame({"x": [np.nan, 1.5, np.nan]}))
    assert read_table(tmp_path / "table.csv")["x"].isna().tolist() == [True, False, True]


@pytest.mark.parametrize("names", [["1", "2"], ["inf", "-inf"], ["True", "False"]])
def test_text_that_reads_as_numbers_is_refused(tmp_path, names):
    with pytest.raises(ValueError, match="column case would be read as"):
        write_table(tmp_path / "table.csv", pd.DataFrame({"case": names}))
    assert list(tmp_path.iterdir()) == []


def test_text_that_only_resembles_numbers_stays_text(tmp_path):
    table = pd.DataFrame({"case": ["nan", "1_000", "0x1", "1", None, "1e"]})
    write_table(tmp_path / "table.csv", table)
    pd.testing.assert_frame_equal(read_table(tmp_path / "table.csv"), table)


def test_large_tables_are_read_quickly(tmp_path):
    rows = 50_000
    numbers = np.random.default_rng(1).normal(size=rows)
    table = pd.DataFrame({"case": ["Re400"] * rows, "event": np.arange(rows), "horizon": numbers})
    write_table(tmp_path / "table.csv", table)
    pd.testing.assert_frame_equal(read_table(tmp_path / "table.csv"), table)


def test_repeated_columns_are_refused(tmp_path):
    with pytest.raises(ValueError, match="share a name"):
        write_table(tmp_path / "table.csv", pd.DataFrame([[1, 2]], columns=["a", "a"]))
