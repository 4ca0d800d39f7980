"""The benchmark: cases are frozen campaigns, whose tasks are exported, and files of forecasts."""

import re
import subprocess
import sys
from pathlib import Path

import netCDF4
import numpy as np
import pandas as pd
import pytest
import yaml

from burstcast.files.netcdf import read_attributes, read_netcdf, read_rows
from burstcast_workflow.commands import benchmark
from burstcast_workflow.commands.command_line import main
from burstcast_workflow.commands.leaderboard import read_leaderboard, write_leaderboard

SMALL = yaml.safe_load("""
results: results/small
random_seed: 2026
campaign: [{cases: [small], forecasters: {quadratic: {}}}]
cases:
  small:
    parameters: {reynolds: 400}
    event_threshold: 0.07
    training: {series: 3}
    recycle_validation: {series: 3}
    lyapunov: {series: 8}
    test_series: 8
    ensemble: {series: 20, time_step: 0.5, sampling_stride: 2, duration: 500}
classification: {prediction_times_lt: [1, 3], longest_prediction_time_lt: 3}
horizon: {events: 5, longest_lead_time_lt: 2}
control: {forecasters: {esn: null, equations: null}}
statistics: {forecasters: {esn: null}}
""")

HEAD = "case=small case_version={case_version} seed={seed}"


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A working directory, and beside it a benchmark of a small case, whose data are not known."""
    directory = tmp_path_factory.mktemp("benchmark")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(benchmark, "DIRECTORY", directory)
        patch.setattr(benchmark, "LEADERBOARD", directory / "leaderboard.csv")
        (directory / "frozen.yaml").write_text(yaml.safe_dump(SMALL))
        freeze(directory, "?")
        write_leaderboard(directory / "leaderboard.csv", [])
        (directory / "work").mkdir()
        patch.chdir(directory / "work")
        yield directory


def freeze(directory, data):
    """Declare the small case, with this digest."""
    case = {"version": 3, "campaign": "frozen", "data": data, "about": "Small."}
    (directory / "cases.yaml").write_text(yaml.safe_dump({"small": case}))


@pytest.fixture(scope="module")
def task(place):
    """The exported file of the small case: what it makes is frozen now."""
    assert main(["benchmark", "export"]) == 2
    path = Path("results/small/small/forecast_task.nc")
    freeze(place, read_attributes(path)["case_version"])
    return path


@pytest.fixture(scope="module")
def facts(task):
    found = read_attributes(task)
    return {name: found[name] for name in ("case", "case_version", "seed")}


@pytest.fixture(scope="module")
def truth(task):
    """True observable after the starting points, and after those of the horizon until the event."""
    ensemble, found = task.with_name("ensemble.nc"), read_netcdf(task)
    facts = read_attributes(task)
    observable = read_rows(ensemble, "observable", 3, 11)
    ahead = 1 + np.arange(facts["forecast_steps"])
    at = found["start_step"][:, np.newaxis] + ahead
    events, noisy = read_netcdf(task.with_name("events.nc")), found["horizon_washout"]
    horizon = np.zeros((len(noisy), facts["horizon_steps"]))
    for row, washout in enumerate(noisy):
        seen = events["observed"]
        for event, series in enumerate(seen):
            for step in np.flatnonzero((series == washout[-1]).all(axis=1)):
                following = events["truth"][event, step + 1 :][: horizon.shape[1]]
                horizon[row, : len(following)] = following
    return observable[found["series"][:, np.newaxis], at], horizon


def write(path, facts, **variables):
    with netCDF4.Dataset(path, "w") as file:
        file.setncatts(facts)
        for name, array in variables.items():
            axes = [f"{name.removesuffix('observable')}{axis}" for axis in ("point", "step")]
            for axis, length in zip(axes, array.shape, strict=True):
                file.createDimension(axis, length)
            file.createVariable(name, "f8", axes)[...] = array
    return str(path)


def scores_of(path):
    found = pd.read_csv(Path(path).with_suffix(".scores.csv"))
    return found.fillna({"prediction_time_lt": 0}).set_index(["metric", "prediction_time_lt"])


def test_another_digest_is_an_error(place, task, capsys):
    freeze(place, "0123456789abcdef")
    assert main(["benchmark", "export", "--case", "small"]) == 2
    digest = read_attributes(task)["case_version"]
    said = f"digest {digest}) than the frozen ones (0123456789abcdef)"
    assert said in capsys.readouterr().err
    freeze(place, digest)
    assert main(["benchmark", "export", "--seed", "7"]) == 0
    other = read_attributes("results/small_7/small/forecast_task.nc")
    assert (other["seed"], other["case_version"] != digest) == (7, True)


def test_the_truth_scores_best(task, facts, truth, tmp_path, capsys):
    observable, horizon = truth
    path = write(tmp_path / "true.nc", facts, observable=observable, horizon_observable=horizon)
    board = tmp_path / "board.csv"
    options = ["--about", "the truth", "--leaderboard", str(board)]
    assert main(["benchmark", "score", path, *options]) == 0
    assert "| true *     | 1.00 (1.00 to 1.00)" in capsys.readouterr().out
    (row,) = read_leaderboard(board)
    told = {"forecaster": "true", "about": "the truth", "case_version": "3", "seed": "2026"}
    assert {name: row[name] for name in told} == told
    assert {row[name] for name in ("f_score_1lt", "precision_3lt", "brier_skill_3lt")} == {"1"}
    assert row["mean_horizon_lt"] == "2"
    found = scores_of(path)["value"]
    assert found["mean_lead_time_lt", 0] == found["mean_possible_lead_time_lt", 0] > 1
    assert found["missed_fraction", 0] == found["calibration_error", 1] == 0


def test_rows_of_files_are_those_of_the_tables(task, facts, truth, tmp_path):
    """Probabilities in CSV: all that a row has stands in a table of the campaign."""
    observable, _ = truth
    times = read_netcdf(task)["prediction_time_lt"]
    rows = [
        f"{point},{time:g},{0.2 + 0.6 * (one.max() > 0.07):g}"
        for point, one in enumerate(observable)
        for time in times
    ]
    path = tmp_path / "given.csv"
    head = f"# {HEAD.format(**facts)}", "point,prediction_time_lt,probability"
    path.write_text("\n".join([*head, *rows]))
    board = tmp_path / "board.csv"
    options = ["--alarm-threshold", "0.5", "--name", "mine", "--leaderboard", str(board)]
    assert main(["benchmark", "score", str(path), *options]) == 0
    (row,) = read_leaderboard(board)
    tables = task.parent / "tables"
    ends = pd.read_csv(tables / "classification_intervals.csv")
    ends = ends.query("forecaster == 'external_scored' and prediction_time_lt == 3")
    ends = ends.set_index("metric")
    counts = pd.read_csv(tables / "classification.csv")
    counts = counts.query("forecaster == 'external_scored' and prediction_time_lt == 3")
    leads = pd.read_csv(tables / "lead_times.csv").query("alarm == 'external-scored'")
    lead = leads[leads["metric"] == "mean_lead_time_lt"]
    assert 0 < counts["recall"].item() <= 1
    assert float(row["recall_3lt"]) == pytest.approx(counts["recall"].item(), rel=1e-5)
    assert float(row["f_score_3lt_low"]) == pytest.approx(ends["low"]["f_score"], rel=1e-5)
    assert float(row["mean_lead_time_lt"]) == pytest.approx(lead["value"].item(), rel=1e-5)
    told = [row[name] for name in ("alarm_threshold", "mean_horizon_lt", "forecaster")]
    assert told == ["0.5", "", "mine"]


def test_a_forecaster_of_the_frozen_campaign_has_a_row(task, tmp_path, capsys):
    """The forecaster of the campaign itself; its alarms are those of its trajectories."""
    board = str(tmp_path / "board.csv")
    chosen = ["--forecaster", "small", "quadratic", "--leaderboard", board]
    assert main(["benchmark", "score", *chosen]) == 0
    (row,) = read_leaderboard(board)
    table = pd.read_csv(task.parent / "tables" / "classification.csv")
    score = table.query("forecaster == 'quadratic' and prediction_time_lt == 1")["f_score"].item()
    assert float(row["f_score_1lt"]) == pytest.approx(score, rel=1e-5)
    assert float(row["mean_horizon_lt"]) > 0
    assert scores_of("small_quadratic.csv")["value"]["f_score", 1] == score


def test_nothing_is_written_where_forecasts_are_wrong(facts, truth, tmp_path, capfd):
    path = write(tmp_path / "a.nc", facts, observable=np.full_like(truth[0], np.nan))
    board = tmp_path / "board.csv"
    with pytest.raises(SystemExit):
        main(["benchmark", "score", path, "--leaderboard", str(board)])
    assert "observable of point 0, step 1: observable is nan; expected" in capfd.readouterr().err
    assert [one.name for one in tmp_path.iterdir()] == ["a.nc"]
    other = write(tmp_path / "b.nc", {**facts, "seed": 7}, observable=truth[0])
    with pytest.raises(SystemExit):
        main(["benchmark", "score", path, other])
    assert "b.nc is of the seed 7; expected is 2026" in capfd.readouterr().err
    with pytest.raises(SystemExit):
        main(["benchmark", "score", path, "--alarm-threshold", "2"])
    assert "alarm_threshold" in capfd.readouterr().err
    assert main(["benchmark", "export", "--case", "smal"]) == 2
    assert "no case 'smal' (did you mean 'small'?)" in capfd.readouterr().err


def test_the_script_of_the_page_runs_without_burstcast(task, facts, tmp_path):
    page = task.with_suffix(".md").read_text(encoding="utf-8")
    (script,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    assert "burstcast" not in script
    assert len([line for line in script.splitlines() if line]) <= 24
    (tmp_path / "forecast_task.nc").write_bytes(task.read_bytes())
    subprocess.run([sys.executable, "-c", script], cwd=tmp_path, check=True)
    now = read_netcdf(task)["washout_observable"][:, -1:]
    assert (read_netcdf(tmp_path / "persistence.nc")["observable"] == now).all()
    assert main(["benchmark", "score", str(tmp_path / "persistence.nc")]) == 0
    assert scores_of(tmp_path / "persistence.nc")["value"]["recall", 1] == 0


def test_an_export_has_what_forecasts_need_and_no_truth(task):
    found, facts = read_netcdf(task), read_attributes(task)
    energy = 0.5 * (found["washout"] ** 2).sum(axis=2)
    np.testing.assert_allclose(found["washout_observable"], energy, rtol=1e-14)
    assert facts["forecast_steps"] == found["window_last_step"][-1]
    assert facts["components"].split() == [f"a{number}" for number in range(1, 10)]
    # nothing reaches beyond a starting point, and nothing true is there
    assert found["washout"].shape[1] == found["horizon_washout"].shape[1]
    true = read_rows(task.with_name("ensemble.nc"), "state", 0, 11).ravel()
    for array in found.values():
        assert array.dtype.kind != "f" or not np.isin(array, true[true != 0]).any()


def test_the_page_names_everything_in_the_file(task, facts):
    page = task.with_suffix(".md").read_text(encoding="utf-8")
    for name in read_netcdf(task):
        assert f"`{name}`" in page, name
    of_jobs = {*read_attributes(task.with_name("ensemble.nc"))}
    for name in {*read_attributes(task)} - of_jobs:
        assert f"`{name}`" in page or name == "observable", name
    assert "$" not in page
    assert page.count(f"# {HEAD.format(**facts)}") == 1
