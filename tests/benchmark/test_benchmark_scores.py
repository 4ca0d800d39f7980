"""Scores of the benchmark against scikit-learn, and against forecasts whose scores are known."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from helpers_benchmark import table, write_csv, write_netcdf
from sklearn.metrics import (
    brier_score_loss,
    f1_score,
    precision_score,
    recall_score,
    roc_auc_score,
)

from burstcast.benchmark.forecast_files import Forecasts
from burstcast.benchmark.leaderboard import (
    COLUMNS,
    PATH,
    as_markdown,
    compared_with,
    read_leaderboard,
    row_of,
    with_row,
    write_leaderboard,
)
from burstcast.benchmark.scores import score_forecasts
from burstcast.files.netcdf import read_attributes
from burstcast.forecast.windows import crosses, summarise
from burstcast.forecasters._recorded import RecordedForecasts
from burstcast_workflow.commands.command_line import main

ROOT = Path(__file__).parents[2]


def by_name(scores):
    return {(one.metric, one.prediction_time_lt): one.value for one in scores}


def true_horizon(data):
    """True observable after each point of the horizon; zeros after the event."""
    event, step = data.horizon_starts
    found = np.zeros((len(event), data.search.longest_lead_time))
    for row, (one, start) in enumerate(zip(event, step, strict=True)):
        ahead = data.truth_before_events[one, start + 1 :]
        found[row, : len(ahead)] = ahead
    return found


def test_the_truth_scores_best(data, true_observable):
    member = summarise(true_observable.T, data.case.boundaries)
    found = by_name(score_forecasts(data, Forecasts((member,), None, true_horizon(data))))
    for time in data.case.prediction_times_lt:
        assert found["base_rate", time] > 0
        for metric in ("precision", "recall", "f_score", "brier_skill", "roc_area"):
            assert found[metric, time] == 1, metric
        assert found["calibration_error", time] == 0
    assert found["mean_lead_time_lt", None] == found["mean_possible_lead_time_lt", None] > 1
    assert found["missed_fraction", None] == 0
    assert found["mean_horizon_lt", None] == data.case.longest_lead_time_lt


def test_probabilities_score_as_scikit_learn_has_it(data):
    generator = np.random.default_rng(3)
    truth = np.stack(
        [
            crosses(data.test.truth, *data.case.windows(time), data.case.event_threshold)
            for time in data.case.prediction_times_lt
        ],
        axis=1,
    )
    probability = np.clip(generator.normal(0.3 + 0.3 * truth, 0.2), 0, 1).round(2)
    found = by_name(score_forecasts(data, Forecasts((), probability, None), 0.4))
    quiet = data.test.seen.max(axis=1) < data.case.event_threshold
    assert 0 < quiet.sum() < len(quiet)
    for column, time in enumerate(data.case.prediction_times_lt):
        happened, forecast = truth[quiet, column], probability[quiet, column]
        alarm = forecast >= 0.4
        rate = happened.mean()
        brier = brier_score_loss(happened, forecast)
        for metric, expected in (
            ("precision", precision_score(happened, alarm)),
            ("recall", recall_score(happened, alarm)),
            ("f_score", f1_score(happened, alarm)),
            ("brier_score", brier),
            ("brier_skill", 1 - brier / (rate * (1 - rate))),
            ("roc_area", roc_auc_score(happened, forecast)),
        ):
            assert found[metric, time] == pytest.approx(expected, rel=1e-12), metric
    assert ("mean_horizon_lt", None) not in found


def test_members_vote(data, true_observable):
    """Two of three members are right, the third one never warns: probabilities are 2/3 and 0."""
    right = summarise(true_observable.T, data.case.boundaries)
    never = summarise(np.zeros_like(true_observable.T), data.case.boundaries)
    three = Forecasts((right, never, right), None, None)
    found = by_name(score_forecasts(data, three))
    for time in data.case.prediction_times_lt:
        rate = found["base_rate", time]
        assert found["f_score", time] == 1
        assert found["brier_score", time] == pytest.approx(rate / 9)
    strict = by_name(score_forecasts(data, three, alarm_threshold=0.7))
    assert strict["recall", 1.0] == 0
    assert strict["brier_score", 1.0] == found["brier_score", 1.0]


def test_horizons_are_found_in_the_recorded_forecasts(data):
    """Right for a step less than half a Lyapunov time: no start reaches its event."""
    steps = data.case.steps(0.5) - 1
    horizon = true_horizon(data)
    horizon[:, steps:] = 9.0
    never = np.zeros((len(data.test.points), 2))
    found = by_name(score_forecasts(data, Forecasts((), never, horizon)))
    assert found["mean_horizon_lt", None] == steps / data.case.steps_per_lyapunov_time
    shuffled = Forecasts((), never, horizon[::-1])
    assert by_name(score_forecasts(data, shuffled))["mean_horizon_lt", None] < 0.2


def test_intervals_hold_the_score_and_grow_with_fewer_series(data, true_observable):
    generator = np.random.default_rng(1)
    noisy = true_observable + generator.normal(0, 0.02, true_observable.shape)
    member = summarise(noisy.T, data.case.boundaries)
    scores = score_forecasts(data, Forecasts((member,), None, None))
    (one,) = (s for s in scores if s.metric == "f_score" and s.prediction_time_lt == 1)
    assert one.low < one.value < one.high
    assert scores == score_forecasts(data, Forecasts((member,), None, None))


def test_recorded_forecasts_go_on_from_their_washouts():
    washouts = np.arange(24.0).reshape(4, 3, 2)
    outputs = np.arange(40.0).reshape(4, 10, 1)
    recorded = RecordedForecasts(washouts, outputs)
    memory = recorded.start(np.ascontiguousarray(washouts[[2, 0]].transpose(1, 2, 0)))
    first, memory = recorded.advance(memory, 4)
    later, _ = recorded.advance(memory[:, 1:], 6)
    assert np.array_equal(first[:, 0].T, outputs[[2, 0], :4, 0])
    assert np.array_equal(later[:, 0, 0], outputs[0, 4:, 0])
    again = RecordedForecasts.restore(recorded.record(), None)
    assert np.array_equal(again.start(washouts[[1]].transpose(1, 2, 0)), [[1.0], [0.0]])
    with pytest.raises(ValueError, match="1 of 2 washouts have no recorded forecast"):
        recorded.start(np.stack([washouts[0], washouts[1] + 1], axis=2))
    with pytest.raises(ValueError, match="have 10 steps, and 11 are requested"):
        recorded.advance(memory, 7)
    with pytest.raises(NotImplementedError):
        RecordedForecasts.fit(washouts, None)


# -- the leaderboard -------------------------------------------------------------------------------


@pytest.fixture
def row(data, true_observable):
    def made(forecaster, shift=0.0):
        member = summarise(true_observable.T - shift, data.case.boundaries)
        scores = score_forecasts(data, Forecasts((member,), None, None))
        wide = replace(scores[0], metric="f_score", prediction_time_lt=3.0, value=1 - shift)
        return row_of(
            data,
            [*scores, wide],
            forecaster=forecaster,
            about="made up",
            alarm_threshold=0.5,
            version="0.1.0",
            commit="abc",
        )

    return made


def test_rows_are_kept_in_order_and_replaced(row, tmp_path):
    path = tmp_path / "leaderboard.csv"
    rows = []
    for one in (row("b", 0.01), row("a", 0.02), row("c")):
        rows = with_row(rows, one)
        write_leaderboard(path, rows)
        assert read_leaderboard(path) == rows
    assert [one["forecaster"] for one in rows] == ["c", "b", "a"]
    again = with_row(rows, {**row("c", 0.03), "commit": "def"})
    assert [(one["forecaster"], one["commit"]) for one in again] == [
        ("b", "abc"),
        ("a", "abc"),
        ("c", "def"),
    ]
    other = {**row("z"), "seed": "7"}
    assert compared_with(again, other) == [other]
    assert [one["forecaster"] for one in compared_with([*again, other], again[0])] == list("bac")
    assert set(rows[0]) == set(COLUMNS)


def test_the_table_shows_scores_with_intervals(row):
    one = row("c")
    lines = as_markdown([one, row("b", 0.05)], one).splitlines()
    assert lines[0].startswith("| forecaster | F, 1 LT ")
    assert lines[2].startswith("| c *        | 1.00 (1.00 to 1.00)")
    assert lines[2].rstrip(" |").endswith("-")  # no horizon
    assert len({len(line) for line in lines}) == 1


def test_the_leaderboard_is_sound_and_another_table_is_none(tmp_path):
    rows = read_leaderboard()
    assert len({tuple(one[key] for key in COLUMNS[:4]) for one in rows}) == len(rows)
    for one in rows:
        assert len(one["commit"]) == 40, one["forecaster"]
        assert float(one["f_score_3lt_low"]) <= float(one["f_score_3lt"]) <= 1
    (tmp_path / "other.csv").write_text("a,b\n1,2\n")
    with pytest.raises(ValueError, match="is no leaderboard"):
        read_leaderboard(tmp_path / "other.csv")
    assert PATH.is_file()


# -- the command -----------------------------------------------------------------------------------


@pytest.mark.usefixtures("small_is_known")
def test_the_command_exports_scores_and_adds_a_row(data, facts, true_observable, tmp_path, capsys):
    assert main(["benchmark", "export", str(tmp_path / "e"), "--case", "small"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said == [str(tmp_path / "e" / name) for name in ("small.nc", "README.md")]
    path = tmp_path / "perfect.nc"
    write_netcdf(path, facts, observable=(("point", "step"), true_observable))
    board = tmp_path / "board.csv"
    options = ["--about", "the truth", "--leaderboard", str(board)]
    assert main(["benchmark", "score", str(path), *options]) == 0
    text = capsys.readouterr().out
    assert "\nf_score                 1.000 (1.000 to 1.000)" in text
    assert "| perfect *" in text
    (row,) = read_leaderboard(board)
    assert (row["forecaster"], row["about"], row["case_version"]) == ("perfect", "the truth", "3")
    with open(tmp_path / "perfect.scores.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert {one["metric"] for one in rows} > {"f_score", "brier_skill", "calibration_error"}
    (recall,) = (
        one for one in rows if one["metric"] == "recall" and one["prediction_time_lt"] == "1.0"
    )
    assert recall["value"] == "1.0"


@pytest.mark.usefixtures("small_is_known")
def test_csv_and_netcdf_have_the_same_scores(data, facts, true_observable, tmp_path, capsys):
    shifted = true_observable - 0.004
    write_netcdf(tmp_path / "a.nc", facts, observable=(("point", "step"), shifted))
    write_csv(tmp_path / "b.csv", "point,step,observable", table(shifted, (0, 1)))
    for name in ("a.nc", "b.csv"):
        assert main(["benchmark", "score", str(tmp_path / name)]) == 0
    capsys.readouterr()
    found = [(tmp_path / f"{name}.scores.csv").read_text() for name in ("a", "b")]
    assert found[0] == found[1]
    assert "\nf_score,1.0,1.0," not in found[0]


@pytest.mark.usefixtures("small_is_known")
def test_nothing_is_written_where_forecasts_are_wrong(data, facts, tmp_path, capsys):
    path = tmp_path / "a.nc"
    values = np.full((len(data.test.points), data.task.steps), np.nan)
    write_netcdf(path, facts, observable=(("point", "step"), values))
    board = tmp_path / "board.csv"
    assert main(["benchmark", "score", str(path), "--leaderboard", str(board)]) == 2
    caught = capsys.readouterr()
    assert caught.out == ""
    assert caught.err.startswith(
        f"burstcast benchmark score: {path}, observable of point 0, step 1"
    )
    assert [one.name for one in tmp_path.iterdir()] == ["a.nc"]
    assert main(["benchmark", "score", str(path), "--alarm-threshold", "2"]) == 2
    assert "--alarm-threshold must be between 0 and 1, not 2" in capsys.readouterr().err


def test_the_page_of_the_leaderboard_is_made_of_it(capsys):
    assert main(["benchmark", "leaderboard"]) == 0
    page = ROOT / "docs" / "leaderboard.md"
    assert capsys.readouterr().out == page.read_text(encoding="utf-8"), "run make pages"


@pytest.mark.usefixtures("small_is_known")
def test_another_seed_may_be_exported(tmp_path, capsys):
    for name, more in (("a", []), ("b", ["--seed", "7"])):
        assert main(["benchmark", "export", str(tmp_path / name), "--case", "small", *more]) == 0
    seeds = [read_attributes(tmp_path / name / "small.nc")["seed"] for name in "ab"]
    assert seeds == [2026, 7]
    capsys.readouterr()
