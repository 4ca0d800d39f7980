"""The page of a campaign: its sections, with figures and tables in them, rendered by a template."""

import base64
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd
from jinja2 import Environment, StrictUndefined

MOST_ROWS = 60
"""Of a table, on the page: all rows are in its CSV."""


def render(
    template: Path,
    report: Mapping[str, Any],
    pictures: Mapping[str, Path],
    tables: Mapping[str, Path],
    content: Mapping[str, Any],
) -> str:
    """Text of the page: ``report`` is what it says beside results, ``content`` what is in these.

    ``pictures``, ``tables``: Files by name.
    """
    sections = [
        {
            "title": section["title"],
            "figures": [
                {**figure, **_picture(pictures[figure["name"]])} for figure in section["figures"]
            ],
            "tables": [{**table, **_table(tables[table["name"]])} for table in section["tables"]],
        }
        for section in report["sections"]
    ]
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    page = environment.from_string(template.read_text(encoding="utf-8"))
    return page.render({**report, **content, "sections": sections})


def _picture(path: Path) -> dict[str, Any]:
    content = path.read_bytes()
    return {
        "picture": f"data:image/png;base64,{base64.b64encode(content).decode()}",
        "width": int.from_bytes(content[16:20]) // 2,  # its header tells; 300 dots an inch
    }


def _table(path: Path) -> dict[str, Any]:
    table = pd.read_csv(path)
    return {"rows": rows_of(table.head(MOST_ROWS)), "left_out": max(0, len(table) - MOST_ROWS)}


def rows_of(table: pd.DataFrame | None) -> list[dict[str, str]]:
    """Rows of text, with numbers in three digits; missing ones are empty."""
    if table is None:
        return []
    return [
        {str(name): _cell(value) for name, value in row.items()}
        for row in table.astype(object).to_dict("records")
    ]


def _cell(value: Any) -> str:
    if isinstance(value, str):
        return value
    if pd.isna(value):
        return ""
    return f"{value:.3g}" if isinstance(value, float) and value % 1 else f"{value:g}"
