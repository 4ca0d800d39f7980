"""The frozen cases of the benchmark, and its leaderboard."""

import json
import runpy
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from burstcast.event_forecaster.forecaster import EventForecaster
from burstcast.files.netcdf import read_netcdf
from burstcast_workflow.commands import benchmark
from burstcast_workflow.commands.command_line import main
from burstcast_workflow.commands.leaderboard import (
    COLUMNS,
    alike,
    as_markdown,
    read_leaderboard,
    with_row,
    write_leaderboard,
)
from burstcast_workflow.config.loading import load

ROOT = Path(__file__).parents[2]
FROZEN = sorted({case["campaign"] for case in benchmark.cases().values()})


@pytest.mark.parametrize("name", FROZEN)
def test_frozen_campaigns_are_sound(name, tmp_path, monkeypatch):
    text = (ROOT / "workflow" / "benchmark" / f"{name}.yaml").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    rows = "\n".join(f"2010-03-24T00:{5 * row:02}:00,20,100" for row in range(3))
    (tmp_path / "glucose.csv").write_text(f"time,current,glucose\n{rows}\n")
    config = load(yaml.safe_load(text), defaults=ROOT / "config.yaml")
    assert config["random_seed"] == 2026


def extract_glucose():
    """Write the record to the working directory."""
    pytest.importorskip("bokeh_sampledata", reason="the record is not installed")
    extract = runpy.run_path(str(ROOT / "examples" / "real_records" / "extract.py"))["glucose"]
    extract().to_csv("glucose.csv", index=False, date_format="%Y-%m-%dT%H:%M:%S")


@pytest.mark.parametrize(
    "name",
    ["Re400_seven_modes", "Glucose", pytest.param("Re1000", marks=pytest.mark.long)],
)
def test_the_data_of_each_case_are_frozen(name, tmp_path, monkeypatch):
    """A change of anything that data depend on must raise the version of the case."""
    monkeypatch.chdir(tmp_path)
    if name == "Glucose":
        extract_glucose()
    assert main(["benchmark", "export", "--case", name]) == 0  # compares the digest


def test_classifiers_of_a_notebook_have_the_alarms_of_the_frozen_campaign(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    extract_glucose()
    target, small = "results/benchmark_glucose/Glucose", {"neurons": 60}
    Path("small.yaml").write_text(yaml.safe_dump({"forecasters": {"esn_direct": small}}))
    files = [str(benchmark.DIRECTORY / "glucose.yaml"), "small.yaml"]
    targets = [f"{target}/forecast_task.nc", f"{target}/calibration.json"]
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(ROOT / "Snakefile")]
    subprocess.run([*command, "--configfile", *files, "--", *targets], check=True)
    rules = json.loads(Path(target, "calibration.json").read_text())["alarms"]
    training = read_netcdf(f"{target}/forecast_task.nc")["training"]
    for kind, options in (
        ("precursor", {"classifier": "logistic", "lags_lt": [1, 2, 3]}),
        ("esn_direct", small),
    ):
        fitted = EventForecaster(
            lambda states: -states[..., 0],
            -70.0,
            prediction_times=(1.0, 2.0, 3.0),
            lyapunov_time=20.0,
            sampling_interval=5.0,
            washout=6,
            kind=kind,
            calibration_spacing=1,
            random_seed=2026,
            options={**options, "start_spacing_lt": 1},
        ).fit(training)
        for time, alarm in fitted.alarms_.items():
            rule = rules[kind][f"{time:g}"]["calibrated"]
            assert alarm.calibration.probabilities.tolist() == rule["probabilities"]
            assert alarm.threshold == rule["threshold"]


def test_the_frozen_record_is_left_out_where_it_is_not_here(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    glucose = {"Glucose": benchmark.cases()["Glucose"]}
    monkeypatch.setattr(benchmark, "cases", lambda: glucose)
    assert main(["benchmark", "export"]) == 0
    assert "left out: Glucose, since glucose.csv is not here" in capsys.readouterr().err


def row(forecaster, score):
    texts = dict.fromkeys(COLUMNS, "") | {"f_score_3lt": f"{score:g}", "commit": "abc"}
    keys = {"case": "small", "case_version": "1", "seed": "2026", "forecaster": forecaster}
    return texts | keys


def test_rows_are_kept_in_order_and_replaced(tmp_path):
    path, rows, order = tmp_path / "leaderboard.csv", [], ["small"]
    for one in (row("b", 0.9), row("a", 0.8), row("c", 1)):
        rows = with_row(rows, one, order)
        write_leaderboard(path, rows)
        assert read_leaderboard(path) == rows
    assert [one["forecaster"] for one in rows] == ["c", "b", "a"]
    again = with_row(rows, {**row("c", 0.7), "commit": "def"}, order)
    assert [one["forecaster"] + one["commit"] for one in again] == ["babc", "aabc", "cdef"]
    other = {**row("z", 1), "seed": "7"}
    assert alike([*again, other], again[0]) == again
    (tmp_path / "other.csv").write_text("a,b\n1,2\n")
    with pytest.raises(ValueError, match="is no leaderboard"):
        read_leaderboard(tmp_path / "other.csv")


def test_the_table_shows_scores_with_intervals():
    one = row("c", 1) | {"f_score_1lt": "0.996", "f_score_1lt_low": "0.9", "f_score_1lt_high": "1"}
    lines = as_markdown([one, row("b", -1e-9)], one).splitlines()
    assert lines[0].startswith("| forecaster | F, 1 LT ")
    assert lines[2].startswith("| c *        | 1.00 (0.90 to 1.00) | 1.00    |")
    assert lines[3].startswith("| b          | -                   | 0.00    |")
    assert len({len(line) for line in lines}) == 1


def test_the_leaderboard_is_sound():
    rows = read_leaderboard(benchmark.LEADERBOARD)
    assert len({tuple(one[key] for key in COLUMNS[:4]) for one in rows}) == len(rows)
    for one in rows:
        assert int(one["case_version"]) == benchmark.cases()[one["case"]]["version"]
        assert len(one["commit"]) == 40, one["forecaster"]
        assert float(one["f_score_3lt_low"]) <= float(one["f_score_3lt"]) <= 1


def test_the_page_of_the_leaderboard_is_made_of_it(capsys):
    assert main(["benchmark", "leaderboard"]) == 0
    page = ROOT / "docs" / "leaderboard.md"
    assert capsys.readouterr().out == page.read_text(encoding="utf-8"), "run make pages"
