"""Programs of benchmarks, with their smallest sizes: they run, and print what they measure."""

import importlib
import re
import sys
from dataclasses import replace
from io import StringIO

import numpy as np
import pandas as pd
import pytest
from helpers_configs import ROOT
from sklearn.metrics import brier_score_loss, f1_score

from burstcast.base.files.netcdf import Variable, write_netcdf
from burstcast.forecasts.windows import WindowForecasts
from burstcast.systems.integration import integrate
from burstcast.systems.mfe import MoehlisFaisstEckhardt
from helpers_library import said_by


def said(program, *arguments):
    """What a program prints."""
    return said_by([sys.executable, ROOT / "benchmarks" / program, *arguments], ROOT)


def printed(program, *arguments):
    """Cells of the rows of numbers that a program prints, by their first cell."""
    text = said(program, *arguments)
    rows = re.findall(r"^\| ([^|#]*[^|# -]) +\|(.*\d.*)\|$", text, re.MULTILINE)
    assert rows, text
    return {name: [cell.strip() for cell in cells.split("|")] for name, cells in rows}


def test_scores_of_default_forecasters():
    rows = printed("default_forecasters.py", "lorenz63", "--kinds", "nvar", "persistence")
    (nvar, _, _), (persistence, _, _) = rows["nvar"], rows["persistence"]
    ours, trivial = ([float(score) for score in row.split()] for row in (nvar, persistence))
    assert (np.array(ours) > trivial).all()
    assert ours == sorted(ours, reverse=True)


def test_the_table_of_default_forecasters_is_of_the_kept_rows():
    document = (ROOT / "benchmarks" / "measured.md").read_text(encoding="utf-8")
    lines = said("default_forecasters.py", "table").splitlines()
    assert len(lines) > 10
    assert [line for line in lines if line.strip() not in document] == []


def test_the_choice_of_a_kind():
    """The score of a kind is that of the other table of scores; its choice loses nothing."""
    nvar = printed("default_forecasters.py", "lorenz63", "--kinds", "nvar")["nvar"]
    cells = printed("automatic_kinds.py", "lorenz63", "--kinds", "linear_inverse", "nvar")
    _, chosen, skill, best, of_best, loss, inside, _ = cells["Lorenz 63"]
    assert chosen == best == "`nvar`"
    assert skill == of_best
    assert skill.split()[0] == nvar[1].split()[0]
    assert loss == "0.000 (0.000 to 0.000)"
    assert inside == "yes"


def test_costs_of_a_stream():
    text = said("stream.py", "--neurons", 40, "--members", 2)
    update, near, far, washout, states = map(float, re.findall(r" ([\d.]+) ms$", text, re.M))
    assert 0 < update < washout < near
    assert 0 < states < far


def test_solvers_of_the_ridge_regression(tmp_path):
    start = np.random.default_rng(1).normal(scale=0.1, size=(9, 10)) + 0.3 * np.eye(9)[:, :1]
    states = integrate(MoehlisFaisstEckhardt(400.0), start, 0.25, 16_000, stride=4)
    variable = Variable(("series", "time", "component"), states.transpose(2, 0, 1), "1", "states")
    write_netcdf(tmp_path / "ensemble.nc", {"state": variable}, {})
    rows = printed(
        *("solver_study.py", tmp_path / "ensemble.nc", "--neurons", 40, "--networks", 1),
        *("--tikhonov", 1e-6),  # a problem that each of them solves
    )
    assert set(rows) == {"QR", "LU", "Cholesky", "eigh", "centred moments"}
    failures, errors, objectives = (
        np.array(column, float) for column in zip(*rows.values(), strict=True)
    )
    assert not failures.any()
    assert (errors < 1e-4).all()
    assert np.ptp(objectives) < 0.01


def test_filters_around_a_network(finished):
    rows = printed(
        *("network_filters.py", finished.results / "Re400", "test", "--neurons", 30),
        *("--series", 12, "--filters", "inflation 1.1", "share 0.8"),
    )
    assert set(rows) == {
        *("0: none", "0: inflation 1.1", "0: inflation 1.1, vote of members", "0: share 0.8"),
    }
    assert all(len(cells) == 11 for cells in rows.values())


@pytest.mark.long
def test_intervals_of_scores_hold_the_truth():
    """44 of 50 repetitions at least: nine scores, four shapes of series, two forecasters."""
    text = said("score_intervals.py", 50)
    cells = re.findall(r" (\d+|-), (\d+) ", text)
    ours = [int(own) for own, _ in cells if own != "-"]
    assert (len(cells), len(ours)) == (72, 56)  # reliability and calibration error have none
    assert min(ours) >= 88
    assert min(int(percentile) for _, percentile in cells) < 50


@pytest.mark.long
def test_washouts_of_other_flows_are_found():
    table = pd.read_csv(StringIO(said("consistency.py", "--washouts", 0.5)))
    found = table.set_index("washouts")["inconsistent"]
    kept = pd.read_csv(ROOT / "benchmarks" / "consistency.csv").query("washout_lt == 0.5")
    assert found.index.tolist() == kept["washouts"].tolist()
    assert found["the same"] < 0.12
    assert found["box longer by 5 %"] > 0.9
    assert found.to_numpy() == pytest.approx(kept["inconsistent"].to_numpy(), abs=0.05)


@pytest.mark.long
def test_time_of_planning():
    text = said("planning.py", "--seeds", 1, "--reynolds", 1, "--sizes", 1)
    jobs, seconds, first, again, _, times = map(float, text.splitlines()[-1].split())
    assert jobs > 20
    assert again < first
    assert min(seconds, times) > 0


@pytest.mark.long
def test_gap_of_a_network(tmp_path):
    sizes = ("--neurons", 60)
    variants = ("--sets", 0, "--variants", "paper", "bias 1", "--washouts", "observed")
    trained = said("network_gap.py", "train", tmp_path, *sizes, *variants)
    assert trained.count("objective -") == 2
    report = said("network_gap.py", "report", tmp_path, *sizes)
    table = re.findall(r"^\| 60 \| ([\w ]+) \| observed \| 1 \|", report, re.M)
    assert table == ["paper", "bias 1"]


@pytest.mark.long
def test_a_short_benchmark_measures_each_stage():
    text = said("bench.py", "--quick")
    rows = re.findall(r"^\| ([a-z -]+) \|.*\| 1000 \| ([\d.]+) \|.*$", text, re.M | re.I)
    assert len(rows) == 9
    assert all(float(seconds) > 0 for _, seconds in rows)
    # faster than the machine's own matrix products would be a mistake
    assert 0 < max(map(int, re.findall(r"\| (\d+) % \|", text))) <= 110
    started = dict(re.findall(r"^\| ([^|]+) \| ([\d.]+) \|$", text, re.M))
    assert float(started["Python"]) < float(started["a job from the cache, without its files"])
    assert float(started["again"]) > 0
    _, _, beside = text.partition("Beside ReservoirPy")
    (times,) = re.findall(r"^\| 1000 \| [\d.]+ \| ([\d.]+) \|", beside, re.M)
    assert float(times) > 1


def test_equations_of_a_ring_are_learnt_from_noisy_observations(monkeypatch):
    """Lorenz's equations, from observations with noise of standard deviation 1."""
    monkeypatch.syspath_prepend(ROOT / "benchmarks")
    controllers = importlib.import_module("controllers")
    arena = controllers.Lorenz96Arena()
    learnt = controllers.LearntRing().fit(arena._training(series=6, years=0.5), None).system
    weights = dict(zip(learnt.terms, learnt.weights, strict=True))
    expected = {(): 8.0, (0,): -1.0, (-1, 1): 1.0, (1, 2): -1.0}
    assert weights == {term: pytest.approx(value, abs=0.15) for term, value in expected.items()}
    state = arena._start()
    np.testing.assert_allclose(
        replace(learnt, weights=tuple(expected[term] for term in learnt.terms)).right_hand_side(
            state
        ),
        arena.system.right_hand_side(state),
        rtol=1e-9,
        atol=1e-9,
    )


@pytest.mark.parametrize(("kind", "error"), [("RingAutoregression", 0.1), ("RingNetwork", 0.12)])
def test_maps_of_a_ring_are_learnt_from_noisy_observations(kind, error, monkeypatch):
    """They predict the next sample of Lorenz's equations, from observations with noise of 1."""
    monkeypatch.syspath_prepend(ROOT / "benchmarks")
    models = importlib.import_module("ring_models")
    arena = importlib.import_module("controllers").Lorenz96Arena()
    options = {} if kind == "RingAutoregression" else {"series": 3, "samples": 300, "neurons": 60}
    model = getattr(models, kind)(**options).fit(arena._training(series=4, years=0.5), None)
    states = integrate(arena.system, arena._start(), 0.01, 10, 5)
    outputs, memory = model.advance(states[0], 2)
    assert np.sqrt(np.square(outputs[0] - states[1]).mean()) < error
    assert np.sqrt(np.square(states[0] - states[1]).mean()) > 5 * error
    # each step follows from the one before, at each site alike
    rolled = model.advance(np.roll(outputs[0], 3, axis=0), 1)[0][0]
    np.testing.assert_allclose(rolled, np.roll(memory, 3, axis=0), rtol=1e-3, atol=1e-3)


def test_the_page_has_the_table_of_controllers():
    page = (ROOT / "docs" / "controllers.md").read_text(encoding="utf-8")
    assert said("controllers.py", "table").strip() in page


# -- experiments with smoothing --------------------------------------------------------------------


def test_scores_of_experiments_are_weighted(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "benchmarks")
    starts_of = importlib.import_module("shear_flow_starts").Starts
    generator = np.random.default_rng(3)
    # peaks of 15 samples, where a Lyapunov time has 61
    peaks = np.repeat(generator.random((20, 160)) < 0.04, 15, axis=1)
    observable = np.where(peaks, 0.2, 0.05)
    starts = starts_of(observable, observable)
    assert set(starts.weights) == {1.0, 4.0}
    count = len(starts.weights)
    first = np.zeros((count, 4, 11))
    largest = np.where(generator.random((count, 4, 11)) < 0.3, 0.2, 0.0)
    single = WindowForecasts(
        first[:, 0], largest[:, 0], np.zeros(count, dtype=bool), first, largest
    )
    scores = starts.scores(single)
    for row, time in enumerate((1, 2, 3, 5)):
        windows = slice(2 * time - 1, 2 * time + 1)
        votes = (largest[:, :, windows].max(axis=2) >= 0.1).mean(axis=1)
        truth, weights = starts.truth[row], starts.weights
        expected = f1_score(truth, votes >= 0.5, sample_weight=weights)
        assert scores[f"f_{time}"] == pytest.approx(expected)
        rate = np.average(truth, weights=weights)
        error = brier_score_loss(truth, votes, sample_weight=weights)
        assert scores[f"brier_{time}"] == pytest.approx(1 - error / (rate * (1 - rate)))
    assert scores["f_3_low"] < scores["f_3"] < scores["f_3_high"]


@pytest.mark.long
@pytest.mark.parametrize(
    ("program", "arguments", "rows"),
    [
        ("smoothing.py", ("--forecasters", "nvar", "--sets", 0, "--series", 55, "--tests", 3), 4),
        ("hidden_modes.py", ("--rows", 1, "--series", 55, "--tests", 3), 1),
        (
            "hidden_washouts.py",
            ("--kinds", "esn", "--neurons", 60, "--series", 20, "--tests", 3, "--washouts", 0.5),
            1,
        ),
        ("smoothing_lorenz96.py", ("--neurons", 60, "--seeds", 0, "--tests", 6), 4),
    ],
)
def test_experiments_print_their_tables(program, arguments, rows):
    table = pd.read_csv(StringIO(said(program, *arguments)))
    assert len(table) == rows
    assert table[["f_1", "f_2", "f_3", "f_5"]].to_numpy().min() >= 0
