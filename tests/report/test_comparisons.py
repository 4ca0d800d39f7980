"""Comparisons of the page, on made-up campaigns whose parts are known."""

import drawings
import numpy as np
import pandas as pd
import pytest
from comparisons import (
    TRUE,
    differences,
    f_score,
    gaps,
    inside_counts,
    mean_of,
    over_sets,
    paired,
)
from kept_tables import KEPT, Tables, published_value
from scipy import stats

from burstcast.figures.parts.style import render
from helpers_library import assert_same_picture

SETS = (-0.02, 0.01, 0.03, -0.01, -0.01)  # effects of training sets on F; they sum to zero
SEEDS = (-0.005, 0.005)
CHOICES = 0.04  # by which the authors' choices lower F
TRUTH = 0.25  # part of the gap that true washouts close
ERROR = 0.02  # of one network over test data
NETWORK = {"neurons": 500, "validation": "RV"}


def scored(level, forecaster="esn", part=0.0):
    """Rows of the classification 2 and 3 LT ahead, additive in sets and seeds."""
    for number, effect in enumerate(SETS, 1):
        for seed, of_seed in enumerate(SEEDS):
            for time in (2.0, 3.0):
                value = level - 0.2 * (time - 2) + effect + of_seed
                keys = {"case": f"Re400-training{number}", "reynolds": 400, "seed": seed}
                keys |= {"forecaster": forecaster, **NETWORK, "prediction_time_lt": time}
                yield {**keys, "f_score": value + part * (1 - value)}


def campaign(directory, rows):
    directory.mkdir()
    table = pd.DataFrame(rows)
    table.to_csv(directory / "classification.csv", index=False)
    ends = table.drop(columns="f_score").assign(metric="f_score", low=0.5, high=0.5 + 3.92 * ERROR)
    ends.to_csv(directory / "classification_intervals.csv", index=False)
    return Tables(directory)


@pytest.fixture
def authors(tmp_path):
    return campaign(tmp_path / "authors", [*scored(0.7), *scored(0.7, TRUE, TRUTH)])


@pytest.fixture
def own_choices(tmp_path):
    return campaign(tmp_path / "own", scored(0.7 + CHOICES))


@pytest.fixture
def paper(tmp_path):
    rows = enumerate(scored(0.76))
    return campaign(tmp_path / "paper", [{**r, "case": "Re400", "seed": n} for n, r in rows])


def rows_of(part):
    """Texts of cells by row."""
    cells_of = {}
    for row, _, cell in part:
        cells_of.setdefault(row, []).append(cell)
    return cells_of


def published(time):
    where = {"reynolds": 400, **NETWORK, "prediction_time_lt": time}
    return published_value("classification", "f_score", **where)


def test_differences_are_taken_apart(authors, own_choices, paper):
    row = rows_of(differences(authors, own_choices, paper))["500 neurons, F-score, 3 LT ahead"]
    # by hand: t(4) = 2.776; five sets with our choices have the mean 0.54, the campaign 0.555
    margin = 2.776445 * np.std(SETS, ddof=1) / np.sqrt(5)
    assert row == [
        f"{published(3.0) - 0.555:+.3f}",
        "-0.040 ± 0.000",
        f"-0.015 ± {margin:.3f}",
        f"{published(3.0) - 0.5:+.3f}",
    ]
    nothing = Tables(paper.directory / "none")
    assert differences(authors, nothing, paper) == []


def test_published_values_inside_are_counted_by_one_rule(authors, paper):
    counts = inside_counts(authors, paper)
    of_sets, of_test = np.var(SETS, ddof=1) * 1.2, 2 * ERROR**2
    # by hand, Welch and Satterthwaite: four degrees for the sets, any number for the test series
    degrees = (of_sets + of_test) ** 2 / (of_sets**2 / 4)
    wide = stats.t.ppf(0.975, degrees) * np.sqrt(of_sets + of_test)
    assert 2.0 < stats.t.ppf(0.975, degrees) < 2.3
    values = np.array([published(2.0), published(3.0)])
    apart = {"": abs(values - [0.755, 0.555]), "_authors": abs(values - [0.7, 0.5])}
    assert counts == {
        "values": 2,
        **{
            f"{name}{side}": int((distance <= margin).sum())
            for name, margin in (("narrow", 1.96 * ERROR), ("wide", wide))
            for side, distance in apart.items()
        },
    }


def test_the_gap_is_split_by_true_washouts(authors, own_choices):
    rows = gaps("authors'", authors, f_score(2.0))
    assert rows_of(rows) == {"authors' choices, 500 neurons": ["0.700", "0.775", "0.25 ± 0.00"]}
    assert gaps("our", own_choices, f_score(2.0)) == []


def test_intervals_are_over_training_sets(authors):
    (row,) = over_sets(authors, f_score(3.0)).to_dict("records")
    low, high = stats.t.interval(0.95, 4, 0.5, stats.sem(SETS))
    of_row = [row[name] for name in ("mean", "low", "high", "min", "max")]
    assert of_row == pytest.approx([0.5, low, high, 0.48, 0.53])
    assert row["readout"] == "as in the paper"


@pytest.mark.parametrize(
    ("draw", "name", "campaigns"),
    [
        (drawings.draw_readouts, "readout", [("readout", "readout_2000")]),
        (drawings.draw_late_actuator, "late_actuator", [("aware",)]),
        (drawings.draw_published_scores, "published_scores", [("paper",)]),
        (
            drawings.draw_forecasters,
            "forecasters",
            [("paper",), ("readout",), ("beyond_the_paper",)],
        ),
    ],
)
def test_figures_are_those_of_the_kept_tables(draw, name, campaigns):
    figure = draw(*(Tables(*(KEPT / part for part in campaign)) for campaign in campaigns))
    assert_same_picture(render(figure, "png"), KEPT.parent / "images" / f"{name}.png")


def test_an_interval_of_a_mean_is_that_of_students_test():
    values = [0.1, 0.4, 0.2, 0.7]
    expected = stats.ttest_1samp(values, 0.0).confidence_interval(0.95)
    mean = mean_of(values)
    assert (mean.low, mean.high) == pytest.approx((expected.low, expected.high))
    assert np.isnan(mean_of([0.5]).margin)


def covers(interval, truth):
    return interval.low <= truth <= interval.high


@pytest.mark.parametrize("of_set", [0.0, 0.01, 0.03])
def test_the_training_set_is_the_unit_of_pairs(of_set):
    """Two kinds of networks on five sets with two seeds, whose difference varies with the set."""
    rng, truth, repetitions = np.random.default_rng(81), -0.015, 800
    within, pooled = 0, 0
    for _ in range(repetitions):
        shared = rng.normal(scale=0.02, size=(5, 1))  # the set is good or bad for both kinds
        change = truth + rng.normal(scale=of_set, size=(5, 1))  # and suits one of them more
        first, second = (
            pd.DataFrame(0.76 + shared + part + rng.normal(scale=0.014, size=(5, 2)))
            for part in (change, 0.0)
        )
        within += covers(paired(first, second), truth)
        pooled += covers(mean_of((first - second).to_numpy().ravel().tolist()), truth)
    assert 0.93 <= within / repetitions <= 0.97
    if of_set:  # pairs of a set are not independent
        assert pooled / repetitions < 0.93


def test_pairs_are_of_the_sets_and_seeds_that_both_have():
    first = pd.DataFrame({0: [0.5, 0.7, 0.9], 1: [0.6, np.nan, 0.4]}, index=["a", "b", "c"])
    second = pd.DataFrame({1: [0.5, 0.1], 0: [0.3, 0.2]}, index=["a", "b"])
    # by hand: of a (0.2 + 0.1) / 2, of b 0.5 alone
    difference = paired(first, second)
    assert difference.mean == pytest.approx((0.15 + 0.5) / 2)
    assert difference.count == 2
