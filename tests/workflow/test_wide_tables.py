"""Tables for papers from the rows of a campaign's tables."""

import numpy as np
import pandas as pd

from burstcast.forecasters._names import KEYS
from burstcast.tables.wide import typeset, wide_tables
from burstcast_workflow.tables import registry

LAYOUTS = registry.typeset(["dataset", "control_strategies"])


def rows(case: str, forecaster: str, seeds: list[float]) -> pd.DataFrame:
    """Rows of control under one strategy, by all who forecast."""
    return pd.DataFrame(
        {
            "case": case,
            "forecaster": forecaster,
            "neurons": 40 if forecaster == "esn" else np.nan,
            "validation": "RV" if forecaster == "esn" else np.nan,
            "seed": seeds,
            "strategy": "prediction_triggered",
            "delay_lt": 0.0,
            "prediction_time_lt": 1.0,
            "metric": "exceedance_controlled",
            "value": [0.1 + seed for seed in seeds],
            "low": 0.0,
            "high": 1.0,
        }
    )


def test_seeds_tell_networks_apart_also_after_a_case_without_networks():
    table = pd.concat(
        [
            rows("alpha", "equations", [np.nan]),
            rows("Zeta", "esn", [0, 1]),
            rows("Zeta", "equations", [np.nan]),
        ],
        ignore_index=True,
    )
    found = {
        case: texts for case, texts, _ in wide_tables(table, LAYOUTS["control_strategies"], KEYS)
    }
    assert list(found) == ["alpha", "Zeta"]
    assert [len(texts) for texts in found.values()] == [1, 3]
    assert "seed" not in found["alpha"]
    assert list(found["Zeta"]["seed"]) == ["0", "1", ""]


def test_what_no_case_has_is_no_column():
    layout = LAYOUTS["dataset"]
    names = [name for name in layout["metrics"] if name != "lyapunov_exponent_paper"]
    table = pd.DataFrame({"case": ["lab"], **{name: [1.5] for name in names}})
    ((_, texts, _),) = wide_tables(table, layout, KEYS)
    assert len(texts.columns) == 1 + len(names)
    with_published = table.assign(lyapunov_exponent_paper=0.9)
    ((_, texts, _),) = wide_tables(with_published, layout, KEYS)
    assert len(texts.columns) == 2 + len(names)


def test_settings_that_only_later_cases_have_tell_their_rows_apart():
    """As where only one case has committees: their share of votes stands among the settings."""
    first = rows("Re600", "equations", [0.0])
    second = pd.concat([rows("Re400", "equations", [0.0]) for _ in range(2)])
    second.insert(list(second.columns).index("metric"), "vote_share", [0.1, 0.5])
    joined = pd.concat([first, second])[second.columns]
    (_, of_first, _), (_, of_second, _) = wide_tables(joined, LAYOUTS["control_strategies"], KEYS)
    assert (len(of_first), len(of_second)) == (1, 2)


def test_heads_and_formats_are_those_declared():
    table = rows("Re400", "equations", [0.0])
    text = typeset("control_strategies", table, LAYOUTS["control_strategies"], KEYS)
    assert "under control" in text  # the head of what is the exceedance with control
    assert "$0.1000$ ($0.0000$ to $1.0000$)" in text
    assert r"\label{tab:control_strategies:Re400}" in text
    assert r"\caption{Re400: Costs and gains of control" in text
