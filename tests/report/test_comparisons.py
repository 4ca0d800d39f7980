"""Comparisons of the page, on made-up campaigns whose parts are known."""

from itertools import product

import numpy as np
import pandas as pd
import pytest
from comparisons import (
    HORIZON,
    TRUE,
    Score,
    costs,
    differences,
    f_score,
    gaps,
    inside_counts,
    onsets,
    over_sets,
    own_ranks,
    scatter,
)
from drawings import RV, draw_late_actuator, draw_published_scores, draw_readouts
from kept_tables import KEPT, Tables, published_rows, published_value
from scipy import stats

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


def test_sources_of_scatter_stand_beside_each_other(authors):
    spread = {"standard_deviation_over_training_sets": 0.02, "standard_deviation_over_seeds": 0.03}
    row = {"case": "Re400", "forecaster": "esn", **NETWORK, "prediction_time_lt": 3.0}
    row |= {"metric": "f_score", "mean": 0.5, **spread}
    other = {**row, "prediction_time_lt": 2.0, "mean": 0.7}
    path = authors.directory / "training_realisations.csv"
    pd.DataFrame([row, other]).to_csv(path, index=False)
    rows = rows_of(scatter(authors, (f_score(3.0),)))
    cells = ["0.500", "0.020", "0.030", f"{ERROR:.3f}"]
    assert rows == {"500 neurons, F-score, 3 LT ahead": cells}


def test_how_often_the_own_training_set_is_best(tmp_path):
    ours = {2.0: 0.9, 3.0: 0.2, 4.0: 0.6}
    rows = [
        {"case": case, "forecaster": "esn", **NETWORK, "seed": seed, "prediction_time_lt": time}
        | {"f_score": (value if shift is None else 0.6 + shift) + (0.05, -0.05)[seed]}
        for case, shift in (("Re400", None), ("Re400-training1", 0.1), ("Re400-training2", -0.1))
        for time, value in ours.items()
        for seed in (0, 1)
    ]
    text = own_ranks(campaign(tmp_path / "sets", rows), (2.0, 3.0, 4.0))
    assert text == "the best in 1 and the worst in 1 of 3 F-scores"


@pytest.fixture
def readouts(tmp_path):
    """Two kinds of networks, of two sizes, three training sets, two seeds."""
    generator = np.random.default_rng(0)
    names = ["case", "forecaster", "neurons", "seed", "prediction_time_lt"]
    cases = ("Re400", "Re400-training1", "Re400-training2")
    kinds = ("esn_quadratic", "esn", "equations")
    table = pd.DataFrame(product(cases, kinds, (500, 2000), (0, 1), (1.0, 3.0)), columns=names)
    scores, horizons = generator.uniform(0.2, 0.9, len(table)), generator.uniform(1, 5, len(table))
    table = table.assign(reynolds=400, validation="RV", f_score=scores, mean_horizon_lt=horizons)
    table.to_csv(tmp_path / "classification.csv", index=False)
    last = table[table["prediction_time_lt"] == 3]
    last.to_csv(tmp_path / "horizon.csv", index=False)
    return Tables(tmp_path), last


def test_intervals_are_over_training_sets(readouts):
    tables, rows = readouts
    means = over_sets(tables, f_score(3.0))
    assert means["readout"].tolist() == ["as in the paper"] * 2 + ["squares"] * 2
    for row in means.to_dict("records"):
        of = rows[(rows["forecaster"] == row["forecaster"]) & (rows["neurons"] == row["neurons"])]
        sets = of.groupby("case")["f_score"].mean()
        low, high = stats.t.interval(0.95, 2, sets.mean(), stats.sem(sets))
        expected = [sets.mean(), low, high, sets.min(), sets.max()]
        assert [row[name] for name in ("mean", "low", "high", "min", "max")] == pytest.approx(
            expected
        )


def test_the_figure_has_a_curve_for_each_readout(readouts):
    tables, rows = readouts
    for panel in draw_readouts(tables).axes:
        curves = {line.get_label(): line.get_xdata().tolist() for line in panel.get_lines()}
        assert curves == dict.fromkeys(("as in the paper", "squares"), sorted(set(rows["neurons"])))


@pytest.mark.skipif(not Tables(KEPT / "aware"), reason="the campaign is not kept")
def test_figures_of_kept_campaigns_show_their_numbers():
    paper, aware = Tables(KEPT / "paper"), Tables(KEPT / "aware")
    precision, *_, horizon = draw_published_scores(paper).axes
    medians = paper.medians("classification", "precision", case="Re400", neurons=500, **RV)
    ours = precision.get_lines()[0].get_ydata()
    assert ours == pytest.approx(medians.sort_values("prediction_time_lt")["p50"])
    published = published_rows("horizon", "mean_horizon_lt", reynolds=400, **RV)
    theirs = horizon.get_lines()[1].get_ydata()
    assert theirs == pytest.approx(published.sort_values("neurons")["p50"])
    left, _ = draw_late_actuator(aware).axes
    rules = aware.runs("control_choices", case="Re400", strength=1.0, noise=0.01)
    best = rules[rules["strategy"] == "reactive"].groupby("delay_lt")["left"].min()
    assert left.get_lines()[0].get_ydata() == pytest.approx(100 * best)


def test_only_cases_with_the_same_series_are_ranked_beside_each_other(tmp_path):
    means = {"turbulence": 0.12, "sensors": 0.12, "viscous": 0.1, "viscous_sensors": 0.1}
    cases = {"case": means.keys(), "series_kept": 9, "mean_observable": means.values()}
    pd.DataFrame(cases).to_csv(tmp_path / "dataset.csv", index=False)
    same = {"event": "onset", "metric": "average_precision", "neurons": None, "validation": None}
    same |= {"seed": None, "prediction_time_lt": 1.0, "value": 0.5, "low": 0.1, "high": 1.0}
    ranked = ("sensors", "turbulence", "viscous_sensors")
    rows = pd.DataFrame(
        product(ranked, ("equations_filtered", "climatology")), columns=["case", "alarm"]
    )
    rows.assign(**same, forecaster=rows["alarm"]).to_csv(tmp_path / "ranking.csv", index=False)
    shown = onsets(Tables(tmp_path), "turbulence")
    assert shown[["case", "alarm"]].to_numpy().tolist() == [
        ["sensors", "equations_filtered"],
        ["any", "climatology"],
        ["turbulence", "equations_filtered"],
    ]


def test_the_most_expensive_rules_and_the_sum(tmp_path):
    rules = {"rule": ["cheap", "dear", "middle"], "minutes": [1, 9, 3]}
    table = pd.DataFrame({**rules, "jobs": 2, "memory_mib": 5})
    table.to_csv(tmp_path / "rule_costs.csv", index=False)
    assert rows_of(costs(Tables(tmp_path), 2)) == {
        **{"dear": ["2", "9", "5"], "middle": ["2", "3", "5"]},
        "**all**": ["6", "13", "5"],
    }


def test_scores_name_their_tables():
    assert HORIZON.published(**NETWORK) == published_value(
        "horizon", "mean_horizon_lt", reynolds=400, **NETWORK
    )
    assert np.isnan(Score("none", "horizon", "none").published(**NETWORK))
