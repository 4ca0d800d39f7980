"""Declarations of tables: the page, what jobs are told, and that tables keep to them."""

import ast
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from helpers_configs import ROOT, campaign

from burstcast.base.files.tables import read_table
from burstcast.base.names import KEYS
from burstcast.statistics import warning_signs
from burstcast.tables.joined import joined
from burstcast.tables.makers.warnings_table import ADVICE, OF_NETWORKS
from burstcast.tables.wide import typeset as typeset_tables
from burstcast.tables.wide import wide_tables
from burstcast_workflow.tables import declarations, page, registry
from burstcast_workflow.tables.declarations import COLUMNS, SECTIONS, TABLES
from burstcast_workflow.tables.registry import plain, table_of, typeset, with_percentiles

FILES = with_percentiles(TABLES)
PAPER = campaign()


def columns_of(name, optional=True):
    """All declared columns of a table, or those that every such table has."""
    columns = [*table_of(name).keys, *table_of(name).columns]
    return plain(column for column in columns if optional or column[-1] != "*")


# -- what is declared ------------------------------------------------------------------------------


def test_the_page_is_up_to_date():
    """Made by: make pages."""
    assert (ROOT / "docs" / "tables.md").read_text() == page.text()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"section": "dat"}, r"the section 'dat', which is declared nowhere \(did you mean 'data'"),
        ({"columns": ["peak"]}, "the column 'peak', which is declared nowhere"),
        ({"percentiles": ["peak"]}, "the metric 'peak', which is declared nowhere"),
    ],
)
def test_words_of_a_table_that_are_declared_nowhere_are_told(change, message):
    with pytest.raises(ValueError, match=rf"tables\.yaml: the table mine has {message}"):
        declarations._check("mine", replace(TABLES["dataset"], **change))


def test_every_column_has_its_meaning_and_no_other():
    used = {column for name in FILES for column in columns_of(name)}
    used |= {metric for name in FILES for metric in table_of(name).metrics}
    assert used == set(COLUMNS)
    assert all(column.meaning for column in COLUMNS.values())


@pytest.mark.parametrize("name", TABLES)
def test_a_declaration_agrees_with_itself(name):
    table, columns = TABLES[name], columns_of(name)
    assert len(set(columns)) == len(columns)
    assert table.description.endswith(".")
    assert table.section in SECTIONS
    assert set(table.redefined) <= set(columns)
    assert {*table.percentiles, *table.group_by} <= set(columns)
    for layout in typeset([name]).values():
        shown = set(table_of(layout["source"]).metrics or columns)
        assert set(layout["metrics"]) <= shown
        assert layout["caption"].endswith(".")
        asked = {layout["columns"], *layout["more_rows"], *layout["where"]}
        assert asked <= {*columns_of(layout["source"]), "metric"}


def test_every_sign_has_its_advice():
    tree = ast.parse(Path(warning_signs.__file__).read_text())
    functions = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
    assert functions == set(ADVICE) > set(OF_NETWORKS)
    assert not [text for text in ADVICE.values() if "neurons" in text or "seeds" in text]


# -- what is written -------------------------------------------------------------------------------


def test_what_is_written_is_what_is_declared(finished):
    tables = sorted((finished.results / "tables").glob("*.csv"))
    assert len(tables) > 25
    for path in tables:
        table = read_table(path)
        there = [str(column) for column in table.columns]
        assert [name for name in columns_of(path.stem) if name in there] == there, path.stem
        assert set(columns_of(path.stem, optional=False)) <= set(there), path.stem
        if "metric" in there:
            assert set(table["metric"]) <= set(table_of(path.stem).metrics), path.stem


def test_rows_of_all_cases_have_the_columns_of_any():
    first = pd.DataFrame({"case": ["a"], "window_lt": [1.0], "value": [0.1]})
    second = pd.DataFrame({"case": ["b"], "level": [0.5], "value": [0.25]})
    texts = [table.to_csv(index=False) for table in (first, second)]
    declared = ["case", "level", "margin", "window_lt", "value"]
    assert joined(texts, declared) == ("case,level,window_lt,value\na,,1.0,0.1\nb,0.5,,0.25\n")


# -- for papers ------------------------------------------------------------------------------------

LAYOUTS = registry.typeset(["dataset", "control_strategies"])


def rows(case: str, forecaster: str, seeds: list[float]) -> pd.DataFrame:
    """Rows of control under one strategy, by all who forecast."""
    network = {"neurons": 40, "validation": "RV"} if forecaster == "esn" else {}
    return pd.DataFrame(
        {
            **{"case": case, "forecaster": forecaster, "neurons": np.nan, "validation": np.nan},
            **{**network, "seed": seeds, "strategy": "prediction_triggered", "delay_lt": 0.0},
            **{"prediction_time_lt": 1.0, "metric": "exceedance_controlled"},
            **{"value": [0.1 + seed for seed in seeds], "low": 0.0, "high": 1.0},
        }
    )


def test_seeds_tell_networks_apart_also_after_a_case_without_networks():
    seeds = {("alpha", "equations"): [np.nan], ("Zeta", "esn"): [0, 1]}
    seeds["Zeta", "equations"] = [np.nan]
    table = pd.concat([rows(*network, of) for network, of in seeds.items()], ignore_index=True)
    first, second = wide_tables(table, LAYOUTS["control_strategies"], KEYS)
    assert [first[0], second[0]] == ["alpha", "Zeta"]
    assert (len(first[1]), "seed" in first[1]) == (1, False)
    assert list(second[1]["seed"]) == ["0", "1", ""]


def test_what_no_case_has_is_no_column():
    layout = LAYOUTS["dataset"]
    names = [name for name in layout["metrics"] if name != "lyapunov_exponent_given"]
    table = pd.DataFrame({"case": ["lab"], **{name: [1.5] for name in names}})
    for given, more in ((table, 1), (table.assign(lyapunov_exponent_given=0.9), 2)):
        ((_, texts, _),) = wide_tables(given, layout, KEYS)
        assert len(texts.columns) == len(names) + more


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
    text = typeset_tables("control_strategies", table, LAYOUTS["control_strategies"], KEYS)
    assert "under control" in text  # the head of what is the exceedance with control
    assert "$0.1000$ ($0.0000$ to $1.0000$)" in text
    assert r"\label{tab:control_strategies:Re400}" in text
    assert r"\caption{Re400: Costs and gains of control" in text
