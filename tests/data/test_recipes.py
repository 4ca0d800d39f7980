"""docs/data_recipes.md as it is written: each recipe makes a file that burstcast takes."""

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import scipy.io

from burstcast.data.measured_data import Quantity
from burstcast.data.records import check_regular, needed_columns
from burstcast.data.series_files import read_runs
from burstcast.data.times import time_step_of

PAGE = Path(__file__).parents[2] / "docs" / "data_recipes.md"
RECIPES = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
HOURS = pd.date_range("2021-03-27", periods=48, freq="h", tz="UTC")


def recipe(beginning):
    """The only recipe whose first line begins so."""
    (found,) = [one for one in RECIPES if one.startswith(f"# {beginning}")]
    return found


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


def labelled(path):
    (path / "raw.csv").write_text("run,time,u\nb,0,1\nb,1,2\na,0,3\na,1,4\n")


def matlab(path):
    scipy.io.savemat(path / "raw.mat", {"data": [[1, 2], [3, 4]], "t": [0, 1]})


def realisations(path):
    np.save(path / "raw.npy", [[[1.0, 2], [3, 4]]])


NAN, TWO = np.nan, {"u": [1, 3], "v": [2, 4]}
MINUTES = "time,u\n2020-01-01T00:00,1\n2020-01-01T00:06,2\n2020-01-01T00:15,4\n"
NEWEST = ",u\n2009-08-02,1\n2009-08-01,2\n"
CASES = [
    ("raw.txt: blanks", text("raw.txt", "0 1 2\n1 3 4\n"), "lab.csv", 1, TWO),
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
    ("raw.csv: a column run", labelled, "run_a.csv", 1, {"u": [3, 4]}),
    ("raw.csv: daily", daily, "lab.csv", "1 day", {"heat": [*[0] * 1000, *[5] * 500]}),
    ("raw.mat", matlab, "lab.csv", 1, TWO),
    ("many", realisations, "lab.nc", 0.02, TWO),
]


@pytest.mark.parametrize(("beginning", "prepare", "file", "step", "expected"), CASES)
def test_a_recipe(tmp_path, monkeypatch, beginning, prepare, file, step, expected):
    if beginning == "many":
        pytest.importorskip("xarray")
    monkeypatch.chdir(tmp_path)
    prepare(tmp_path)
    exec(recipe(beginning), {})
    names = needed_columns(file, [Quantity(name) for name in expected])
    (run,) = read_runs(file, names, time_step_of(step)[1])
    check_regular(run, time_step_of(step)[0])
    for name, values in expected.items():
        np.testing.assert_allclose(run.columns[name], list(values), atol=1e-9)


def test_in_a_notebook(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    table = pd.DataFrame({"time": HOURS, "u": np.arange(48.0), "v": np.arange(48.0) ** 2})
    table.drop(index=22).to_csv("raw.csv", index=False)
    found = {}
    exec(recipe("raw.csv: hourly"), found)
    np.testing.assert_array_equal(found["series"][:, :, 0], [np.arange(23, 48)])


def test_every_recipe_is_run():
    assert len(RECIPES) == len(CASES) + 1
