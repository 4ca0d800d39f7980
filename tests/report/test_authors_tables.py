"""Tables of the page about the authors' choices, on made-up campaigns whose parts are known."""

import numpy as np
import pandas as pd
import pytest

from burstcast_report import authors_tables
from burstcast_report.results_tables import Tables, published_value

SETS = (-0.02, 0.01, 0.03, -0.01, -0.01)  # effects of training sets on F; they sum to zero
SHARES = (0.13, 0.16, 0.18, 0.14, 0.14)  # so that F rises by 1 for each unit of the share
SEEDS = (-0.005, 0.005)
CHOICES = 0.04  # by which the authors' choices lower F
TRUTH = 0.25  # part of the gap that true washouts close


def scored(level, forecaster="esn", part=0.0):
    """Rows of the classification 2 and 3 LT ahead, additive in sets and seeds."""
    for number, effect in enumerate(SETS, 1):
        for seed, of_seed in enumerate(SEEDS):
            for time in (2.0, 3.0):
                value = level - 0.2 * (time - 2) + effect + of_seed
                yield {
                    "case": f"Re400-training{number}",
                    "reynolds": 400,
                    "forecaster": forecaster,
                    "neurons": 500,
                    "validation": "RV",
                    "seed": seed,
                    "prediction_time_lt": time,
                    "f_score": value + part * (1 - value),
                }


def write(directory, level, truth=False):
    directory.mkdir()
    rows = pd.DataFrame(
        [*scored(level), *scored(level, authors_tables.TRUE, TRUTH)][: 40 if truth else 20]
    )
    rows.to_csv(directory / "classification.csv", index=False)
    ends = rows.drop(columns="f_score").assign(metric="f_score", low=0.5, high=0.5 + 0.02 * 3.92)
    ends.to_csv(directory / "classification_intervals.csv", index=False)
    cases = ["Re400", *(f"Re400-training{number}" for number in range(1, 6))]
    shares = pd.DataFrame(
        {"case": cases, "event_share": 0.131, "training_event_share": [0.1, *SHARES]}
    )
    shares.to_csv(directory / "dataset.csv", index=False)
    return Tables(directory)


@pytest.fixture
def authors(tmp_path):
    return write(tmp_path / "authors", 0.7, truth=True)


@pytest.fixture
def own(tmp_path):
    return write(tmp_path / "own", 0.7 + CHOICES)


@pytest.fixture
def paper(tmp_path):
    directory = tmp_path / "paper"
    directory.mkdir()
    rows = pd.DataFrame(scored(0.76))
    rows.assign(case="Re400").to_csv(directory / "classification.csv", index=False)
    return Tables(directory)


def cells(table):
    return [
        [cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()[2:]
    ]


def test_training_sets_stand_in_the_order_of_their_shares(authors):
    rows = cells(authors_tables.training_sets(authors))
    assert [row[0] for row in rows] == ["0.130", "0.140", "0.140", "0.160", "0.180"]
    assert [row[1] for row in rows] == ["0.480", "0.490", "0.490", "0.510", "0.530"]
    assert authors_tables.own_share(authors) == "0.100"
    assert authors_tables.share_of_all(authors) == "0.131"


def test_the_variance_of_each_factor_is_known(authors, own):
    first, second = cells(authors_tables.variance_table(authors, own))
    assert first[:3] == ["500 RV", "F-score, 2 LT ahead", "0.700"]
    # without interactions, a component is the variance of the effects themselves
    parts = [np.std(SETS, ddof=1), np.std(SEEDS, ddof=1), 0.0, 0.02, CHOICES / np.sqrt(2)]
    assert first[3:] == second[3:] == [f"{part:.3f}" for part in parts]


def test_differences_are_taken_apart(authors, own, paper):
    row = cells(authors_tables.differences_table(authors, own, paper))[1]
    published = published_value(
        "classification",
        "f_score",
        reynolds=400,
        neurons=500,
        validation="RV",
        prediction_time_lt=3.0,
    )
    total = published - 0.555  # the median of the campaign's networks
    # by hand: t(4) = 2.776; five sets with our choices have the mean 0.54
    margin = 2.776445 * np.std(SETS, ddof=1) / np.sqrt(5)
    assert row[2:] == [
        f"{total:+.3f}",
        "-0.040 ± 0.000",
        f"-0.015 ± {margin:.3f}",
        f"{published - 0.5:+.3f}",
        "+0.040 ± 0.000",
    ]


def test_published_values_are_judged_by_an_interval_over_training_and_test_sets(
    authors, own, paper
):
    first, second = cells(authors_tables.beside_published(authors, own, paper))[:2]
    # by hand: t(4) = 2.776, five sets and one further, two choices of the test series
    margin = 2.776445 * np.sqrt(np.var(SETS, ddof=1) * 1.2 + 2 * 0.02**2)
    assert first[3] == f"0.700 ± {margin:.3f}"
    assert (first[4], first[5], first[6]) == ("inside", "0.740", "0.755")
    published = float(second[2])
    assert second[4] == ("inside" if abs(published - 0.5) <= margin else "outside")


def test_published_values_inside_both_intervals_are_counted(authors, paper, tmp_path):
    ends = pd.DataFrame(scored(0.0)).drop(columns="f_score").assign(metric="f_score")
    ends.assign(case="Re400", low=0.5, high=0.5 + 0.02 * 3.92).to_csv(
        tmp_path / "paper" / "classification_intervals.csv", index=False
    )
    ((kind, count, test_alone, both),) = cells(authors_tables.agreement(authors, paper))
    where = {"reynolds": 400, "neurons": 500, "validation": "RV"}
    published = [
        published_value("classification", "f_score", prediction_time_lt=time, **where)
        for time in (2.0, 3.0)
    ]
    margin = 2.776445 * np.sqrt(np.var(SETS, ddof=1) * 1.2 + 2 * 0.02**2)
    apart = np.array(published) - [0.755, 0.555], np.array(published) - [0.7, 0.5]
    assert (kind, count) == ("classification", "2")
    assert int(test_alone) == (abs(apart[0]) <= 1.96 * 0.02).sum()
    assert int(both) == (abs(apart[1]) <= margin).sum()


def test_the_gap_is_split_by_true_washouts(authors, own):
    rows = cells(authors_tables.gap_table([("authors'", authors), ("ours", own)]))
    assert len(rows) == 2
    assert rows[0][3:] == ["0.700", "0.775", "25 ± 0 %"]


def test_parts_that_a_campaign_lacks_are_left_out(tmp_path, authors):
    nothing = Tables(tmp_path / "none")
    assert not nothing
    assert cells(authors_tables.gap_table([("ours", nothing)])) == []
    assert cells(authors_tables.differences_table(authors, nothing, nothing)) == []
    assert [row[-1] for row in cells(authors_tables.variance_table(authors, nothing))] == ["", ""]
    assert [row[5:] for row in cells(authors_tables.beside_published(authors, nothing, nothing))][
        :2
    ] == [["", ""], ["", ""]]
