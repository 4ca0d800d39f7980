"""Tables of the page on aware forecasters: conditions and verdicts follow from the rows."""

import pandas as pd
import pytest

from burstcast_report import aware_tables, control_tables
from burstcast_report.results_tables import Tables, strategies


def run(case, forecaster, left, acting, **conditions):
    """Rows of one strategy at its best."""
    keys = {
        **{"case": case, "reynolds": 400, "forecaster": forecaster, "neurons": None},
        **{"validation": None, "strategy": "planned", "delay_lt": 0, "horizon_lt": 3, "margin": 0},
        **{"noise": 0.01, "strength": 1, "observed": None, "seed": None, "options": None},
        **{"vote_share": None, "span_lt": 20, "candidates": 2, "scored_flows": 9, **conditions},
    }
    values = {"relative_exceedance": left, "control_fraction": acting, "effort": 0.001}
    return [
        {**keys, "metric": metric, "value": value, "low": 0.5 * value, "high": 2 * value}
        for metric, value in values.items()
    ]


NETWORK = {"neurons": 1000, "validation": "RV", "seed": 0}
REACTIVE = {
    **{"strategy": "reactive", "horizon_lt": None, "margin": None, "level": 0.3},
    "options": "watch=a1 reversible=False",
}


@pytest.fixture
def tables(tmp_path):
    rows = [
        *run("Re400", "esn_aware", 0.0, 0.019, **NETWORK),
        *run("Re400", "esn_aware", 0.0, 0.021, **NETWORK, strength=0.25),
        *run("Re400", "none", 0.5, 0.1, **REACTIVE, observed="modes_4"),
        *run("Re800", "quadratic_aware_filtered", 0.02, 0.01, delay_lt=1),
    ]
    pd.DataFrame(rows).to_csv(tmp_path / "control_choices.csv", index=False)
    scores, ends = [], []
    for case, reynolds, kind, value in (
        ("Re500", 500, "esn", 0.60),
        ("Re500", 500, "esn_aware", 0.585),
        ("Re700", 700, "esn", 0.60),
        ("Re700", 700, "esn_aware", 0.57),
        ("Re400switched", 400, "quadratic_aware_filtered", 0.9),
        ("Re400switched", 400, "equations_filtered", 0.91),
    ):
        network = kind.startswith("esn")
        keys = {
            **{"case": case, "reynolds": reynolds, "forecaster": kind, "seed": None},
            **{"neurons": 1000 if network else None, "validation": "RV" if network else None},
            "prediction_time_lt": 3,
        }
        scores.append({**keys, "f_score": value})
        ends.append({**keys, "metric": "f_score", "low": value - 0.1, "high": value + 0.1})
    pd.DataFrame(scores).to_csv(tmp_path / "classification.csv", index=False)
    pd.DataFrame(ends).to_csv(tmp_path / "classification_intervals.csv", index=False)
    return Tables(tmp_path)


def cells(text):
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines()[2:]]


def test_targets_of_control_are_judged_by_both_limits(tables):
    found = {row[0]: row[-1] for row in cells(aware_tables.targets(tables))}
    assert found == {
        "Re400, in time": "yes",
        "Re400, strength 0.25": "yes",
        "Re800, 1 LT late": "no",  # 2 % are left, 1 % was to be
    }


def test_targets_of_forecasts_are_differences_of_scores(tables):
    found = {row[0]: row[-2:] for row in cells(aware_tables.forecast_targets(tables))}
    assert found["Re500"] == ["-0.015", "yes"]
    assert found["Re700"] == ["-0.030", "no"]
    assert found["Re400switched"] == ["-0.010", "yes"]


def test_choices_name_conditions_and_settings(tables):
    rows = cells(control_tables.choices(tables, "Re400"))
    assert [row[0] for row in rows] == ["in time", "strength 0.25", "observed: modes 4"]
    assert rows[0][1:3] == ["planned, horizon 3 LT, margin 0", "aware network, 1000 neurons, RV"]
    assert rows[0][3:] == ["0 (0 to 0)", "1.9 (0.95 to 3.8)", "1"]
    assert rows[2][1:3] == ["reactive, on a1, level 0.3", ""]
    assert control_tables.choices(tables, "Re999") == ""


def test_settings_have_one_style_and_networks_of_several_seeds_their_seeds(tmp_path):
    rows = [
        *run("Re400", "esn", 0.1, 0.02, **NETWORK, vote_share=0.5, delay_lt=1),
        *run("Re400", "esn", 0.2, 0.02, **{**NETWORK, "seed": 1}, vote_share=0.25, delay_lt=1),
        *run("Re400", "esn", 0.3, 0.02, **{**NETWORK, "neurons": 500}, delay_lt=1),
        *run("Re400", "none", 0.4, 0.1, **REACTIVE, delay_lt=1),
    ]
    found = pd.DataFrame(rows)
    switchings = found[found["metric"] == "effort"].assign(metric="switchings_per_lyapunov_time")
    found.to_csv(tmp_path / "control_choices.csv", index=False)
    pd.concat([found, switchings]).to_csv(tmp_path / "control_strategies.csv", index=False)
    tables = Tables(tmp_path)
    chosen = [row[1:4] for row in cells(control_tables.choices(tables, "Re400"))]
    assert [row[:3] for row in cells(strategies(tables, "Re400", delay_lt=1))] == chosen
    assert [row[:2] for row in chosen] == [
        ["planned, horizon 3 LT, margin 0, vote share 0.5", "1000 neurons, RV, seed 0"],
        ["planned, horizon 3 LT, margin 0, vote share 0.25", "1000 neurons, RV, seed 1"],
        ["planned, horizon 3 LT, margin 0", "500 neurons, RV"],
        ["reactive, on a1, level 0.3", ""],
    ]


def test_scores_stand_by_reynolds_number_with_unseen_ones_in_bold(tables):
    head, _, *rows = aware_tables.scores_by_reynolds(tables, 3).splitlines()
    assert head == "| Re | **500** | **700** |"
    assert rows[0].startswith("| 1000 neurons, RV | 0.600 (0.500 to 0.700) |")
