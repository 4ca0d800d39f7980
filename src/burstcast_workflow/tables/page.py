"""The page of all tables and columns, docs/tables.md: ``make pages``."""

from collections.abc import Iterable, Iterator
from textwrap import fill

from burstcast.base.names import KEYS
from burstcast_workflow.tables.declarations import ENSEMBLE, PERCENTILES, TABLES
from burstcast_workflow.tables.registry import OVER_NETWORKS, column_of, plain

_HEAD = """\
# Tables

Every table of `<results>/tables`, and every column. Each case has tables of the same names in
`<results>/<case>/tables`, with its own rows alone. Tables are CSV: one line of names, numbers in
full, an empty cell where something is undefined or does not apply. Columns without a unit are
counts, shares or names; "observable" is the case's (the kinetic energy of the shear flow).
A column with an asterisk is left out where no row has a value: only some systems, or strategies of
control, have it. Tables for papers (`*.tex`, LaTeX with `booktabs` and `graphicx`) show part of
them: medians and quartiles, or intervals.

This page is made by `make pages` from `workflow/tables.yaml`.
"""
_COLUMNS = "| Column | Unit | Meaning |\n| --- | --- | --- |"


def text() -> str:
    """Text of the page."""
    return _HEAD + "".join(f"{line}\n" for line in _lines())


def _lines() -> Iterator[str]:
    for name, table in TABLES.items():
        yield f"\n## {name}\n\n{fill(table.description, 99)}\n"
        if table.keys:
            yield f"Keys: {_listed(table.keys)}.\n"
        yield _COLUMNS
        for column in table.columns:
            yield _row(column, name)
            if column == "metric":
                yield from (_row(metric, name, "metric ") for metric in table.metrics)
        if table.percentiles:
            of = fill(f"Of {_listed(table.percentiles)}.", 99)
            keys = fill(f"Keys: {_listed([*ENSEMBLE, *table.group_by])}.", 99)
            yield f"\n### {name}_percentiles\n\n{of}\n\n{keys}"
    yield f"\n## Keys, and columns of percentiles\n\n{fill(OVER_NETWORKS, 99)}\n\n{_COLUMNS}"
    yield from map(_row, [*KEYS, *PERCENTILES])


def _listed(names: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in plain(names))


def _row(column: str, table: str = "", kind: str = "") -> str:
    (name,) = plain([column])
    declared = column_of(name, table)
    return f"| {kind}`{name}`{column.removeprefix(name)} | {declared.unit} | {declared.meaning} |"


if __name__ == "__main__":
    print(text(), end="")
