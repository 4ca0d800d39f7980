"""Tables of the whole campaign as outputs of rules: their places in the report, their captions."""

from typing import Any

from snakemake.io import report

from burstcast_workflow.tables.declarations import SECTIONS
from burstcast_workflow.tables.registry import table_of, typeset


def in_report(table: str) -> Any:
    """A table that the report has."""
    return report(
        f"<results>/tables/{table}.csv",
        caption="../report/table.rst",
        category=SECTIONS[table_of(table).section],
        subcategory="Tables",
        labels={"table": table},
    )


def caption_of(table: str) -> str:
    """Caption of a table, in LaTeX."""
    caption: str = typeset([table])[table]["caption"]
    return caption
