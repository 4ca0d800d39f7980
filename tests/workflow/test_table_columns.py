"""The dictionary of all columns: it is up to date, and nothing is written that it does not have."""

import ast
from pathlib import Path

import pytest

from burstcast import warning_signs
from burstcast_workflow import table_columns
from burstcast_workflow.harness.tables import read_table
from burstcast_workflow.jobs.advice import ADVICE
from burstcast_workflow.table_columns import COLUMNS
from burstcast_workflow.table_metrics import SUMMARIES
from burstcast_workflow.table_registry import TABLES, table_of

ROOT = Path(__file__).parents[2]
# of control, the settings of those strategies alone that the campaign has
SOME_OF = ("control_strategies",)


def test_the_dictionary_is_up_to_date():
    """Made by: python -m burstcast_workflow.table_columns > docs/tables.md."""
    assert (ROOT / "docs" / "tables.md").read_text() == table_columns.text()


def test_every_column_has_its_meaning_and_no_other():
    used = set()
    for name in [*TABLES, *(f"{name}_percentiles" for name in SUMMARIES)]:
        text = table_of(name)
        assert text.says.endswith(".")
        used |= {*text.keys, *text.columns.split(), *text.metrics.split()}
    assert used == set(COLUMNS)


@pytest.mark.parametrize("name", SUMMARIES)
def test_percentiles_are_of_columns(name):
    summary = SUMMARIES[name]
    assert {*summary.metrics, *summary.keys} <= set(TABLES[name].columns.split())


def test_what_is_written_is_what_is_declared(finished):
    tables = sorted((finished.project.results / "tables").glob("*.csv"))
    assert len(tables) > 25
    for path in tables:
        text, table = table_of(path.stem), read_table(path)
        declared = [*text.keys, *text.columns.split()]
        written = [str(column) for column in table.columns]
        if path.stem in SOME_OF:
            assert set(written) <= set(declared), path.stem
        else:
            assert written == declared, path.stem
        if "metric" in written:
            assert set(table["metric"]) <= set(text.metrics.split()), path.stem


def test_every_sign_has_its_advice():
    tree = ast.parse(Path(warning_signs.__file__).read_text())
    functions = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
    assert functions == set(ADVICE)
