"""Scores by readout against plain numpy and scipy."""

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from burstcast_report import readout_tables
from burstcast_report.results_tables import Tables

SETS, SEEDS = ("Re400", "Re400-training1", "Re400-training2"), (0, 1)


@pytest.fixture
def scores(tmp_path):
    """Two kinds of networks, of two sizes, three training sets, two seeds."""
    generator = np.random.default_rng(0)
    rows = [
        {"case": case, "forecaster": kind, "neurons": size, "seed": seed}
        | {name: generator.uniform(0.2, 0.9) for name in readout_tables._COLUMNS}
        | {"prediction_time_lt": time}
        for case in SETS
        for kind in ("esn", "esn_quadratic", "equations")
        for size in (500, 2000)
        for seed in SEEDS
        for time in (1.0, 3.0)
    ]
    table = pd.DataFrame(rows)
    table.to_csv(tmp_path / "classification.csv", index=False)
    table.to_csv(tmp_path / "control.csv", index=False)
    at_once = table[table["prediction_time_lt"] == 3.0].drop(columns="prediction_time_lt")
    for name in ("horizon", "statistics"):
        at_once.to_csv(tmp_path / f"{name}.csv", index=False)
    return Tables(tmp_path), table[table["prediction_time_lt"] == 3.0]


def of_sets(table, forecaster, neurons, name="f_score"):
    rows = table[(table["forecaster"] == forecaster) & (table["neurons"] == neurons)]
    return np.array([rows[rows["case"] == case][name].mean() for case in SETS])


def interval(values, digits):
    low, high = stats.t.interval(0.95, 2, values.mean(), stats.sem(values))
    return f"{values.mean():.{digits}f} ({low:.{digits}f} to {high:.{digits}f})"


def test_intervals_are_over_training_sets(scores):
    tables, table = scores
    lines = readout_tables.by_readout(tables).splitlines()[2:]
    assert [line.split(" | ")[:2] for line in lines] == [
        [f"| {name}", size] for name in ("as in the paper", "squares") for size in ("500", "2000")
    ]
    cells = lines[2].split(" | ")
    assert cells[2] == interval(of_sets(table, "esn_quadratic", 500), 3)
    found = of_sets(table, "esn_quadratic", 500, "kantorovich")
    assert cells[4] == f"{found.mean():.4f} ({found.min():.4f} to {found.max():.4f})"


def test_differences_are_paired_by_training_set(scores):
    tables, table = scores
    first, second, *_ = readout_tables.against_the_paper(tables).splitlines()[2:]
    own = of_sets(table, "esn_quadratic", 500)
    for line, size in ((first, 500), (second, 2000)):
        cells = line.split(" | ")
        assert cells[:3] == ["| squares", "500", str(size)]
        assert cells[3] == interval(own - of_sets(table, "esn", size), 3)


def test_the_figure_has_a_curve_for_each_readout(scores, tmp_path):
    tables, _ = scores
    readout_tables.draw(tables, tmp_path / "readout.png")
    assert (tmp_path / "readout.png").read_bytes().startswith(b"\x89PNG")
