"""Tables of a campaign, and the parts of their declarations that jobs and the report read."""

from collections.abc import Container, Iterable
from dataclasses import replace
from typing import Any

from snakemake.io import report

from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.config.control_plans import CONDITIONS
from burstcast_workflow.tables.declarations import (
    COLUMNS,
    ENSEMBLE,
    OPTIONAL,
    PERCENTILES,
    SECTIONS,
    TABLES,
    Column,
    Table,
)

OVER_NETWORKS = (
    "25th, 50th and 75th percentiles over the networks of an ensemble, in long form: one row for "
    "each metric. Networks for which a metric is undefined are left out."
)
_MEDIANS = "Medians over the networks of an ensemble (quartiles)."


def plain(columns: Iterable[str]) -> list[str]:
    """Names of columns, without the mark of optional columns."""
    return [column.removesuffix(OPTIONAL) for column in columns]


def with_percentiles(names: Iterable[str]) -> list[str]:
    """Names of tables; percentiles of a table come before the table, as in the report."""
    files: list[str] = []
    for name in names:
        files += [f"{name}_percentiles", name] if TABLES[name].percentiles else [name]
    return files


def table_of(name: str) -> Table:
    """Declaration of a table, or of a table of percentiles, by its name."""
    if name in TABLES:
        return TABLES[name]
    table = TABLES[name.removesuffix("_percentiles")]
    return replace(
        table,
        description=f"{table.description} {OVER_NETWORKS}",
        keys=ENSEMBLE,
        columns=[*table.group_by, *PERCENTILES],
        metrics=table.percentiles,
        redefined={},
    )


def column_of(name: str, table: str = "") -> Column:
    """Column of a table; an empty declaration if there is none."""
    redefined = TABLES[table].redefined if table in TABLES else {}
    return redefined.get(name) or COLUMNS.get(name, Column(""))


# -- of a campaign ---------------------------------------------------------------------------------


def cases_of(campaign: Campaign, table: str) -> list[str]:
    """Cases that a table has rows of, in the order of the campaign."""
    members = getattr(campaign, table_of(table).rows_of)
    return list(dict.fromkeys(getattr(member, "case", member) for member in members))


def cases_of_tables(campaign: Campaign) -> dict[str, list[str]]:
    """Cases by the name of the table that each case has, percentiles included."""
    names = with_percentiles(name for name, table in TABLES.items() if table.of_cases)
    cases_by_table = {name: cases_of(campaign, name) for name in names}
    return {name: cases for name, cases in cases_by_table.items() if cases}


def tables_by_section(campaign: Campaign) -> dict[str, list[str]]:
    """Names of the tables that cases have, percentiles included, by section of the report."""
    sections: dict[str, list[str]] = {}
    for name in cases_of_tables(campaign):
        sections.setdefault(table_of(name).section, []).append(name)
    return sections


def table_names(campaign: Campaign) -> list[str]:
    """Names of all tables of a campaign, in the order of the report."""
    return [name for name in with_percentiles(TABLES) if cases_of(campaign, name)]


def latex_names(campaign: Campaign) -> list[str]:
    """Names of a campaign's tables for papers."""
    return [*typeset(name for name in TABLES if cases_of(campaign, name))]


def in_report(table: str) -> Any:
    """The file of a table of the whole campaign, which the report has, as an output of a rule."""
    return report(
        f"<results>/tables/{table}.csv",
        caption="../report/table.rst",
        category=SECTIONS[table_of(table).section],
        subcategory="Tables",
        labels={"table": table},
    )


# -- settings of jobs ------------------------------------------------------------------------------

MAKERS = [*dict.fromkeys(table.script for table in TABLES.values() if table.of_cases)]
"""Modules that make tables of cases, in the order of the report."""


def tables_of_maker(script: str) -> list[str]:
    """Names of the tables that a script writes."""
    return [name for name, table in TABLES.items() if table.script == script]


def files_by(script: str) -> list[str]:
    """Names of the files that a script writes: its tables, with their percentiles."""
    return with_percentiles(tables_of_maker(script))


def kinds_of(campaign: Campaign) -> list[str]:
    """What tables call the kinds of forecasters of a campaign, sorted."""
    return sorted({member.name.keys["forecaster"] for member in campaign.forecasters})


def written(names: Iterable[str], unused: Container[str] = ()) -> dict[str, Any]:
    """Declarations for a job that writes tables, without columns that the campaign does not use."""
    declarations: dict[str, Any] = {}
    for name in names:
        table = TABLES[name]
        columns = [*table.keys, *table.columns]
        used = [column for column in columns if column.removesuffix(OPTIONAL) not in unused]
        declarations[name] = {"columns": used}
        if "metric" in columns:
            declarations[name]["metrics"] = table.metrics
        if table.percentiles:
            by = plain([*ENSEMBLE, *table.group_by])
            declarations[name] |= {"percentiles": table.percentiles, "by": by}
    return declarations


def joined(campaign: Campaign, names: Iterable[str]) -> dict[str, Any]:
    """Declarations for a job that joins tables of cases: all possible columns, and layouts."""
    unused, tables = campaign.unused_columns, {name: table_of(name) for name in names}
    columns = {
        name: [column for column in plain([*table.keys, *table.columns]) if column not in unused]
        for name, table in tables.items()
    }
    return {"columns": columns, "latex": typeset(tables)}


def typeset(names: Iterable[str]) -> dict[str, Any]:
    """Declarations for a job that typesets tables: layouts by the name of the LaTeX file."""
    layouts: dict[str, Any] = {}
    for source in names:
        if source not in TABLES:
            continue  # percentiles are typeset with their table
        percentiles = TABLES[source].percentiles
        for name, layout in TABLES[source].latex.items():
            metrics = layout.metrics or percentiles
            shown = {column: COLUMNS[column] for column in [*metrics, *layout.more_rows]}
            formats = {metric: shown[metric].format for metric in metrics}
            layouts[name] = {
                "source": f"{source}_percentiles" if percentiles else source,
                "caption": f"{layout.caption} {_MEDIANS}" if percentiles else layout.caption,
                "metrics": metrics,
                "columns": layout.columns,
                "more_rows": layout.more_rows,
                "where": layout.where,
                # of control, which are shown where they differ
                "conditions": CONDITIONS if "strategy" in layout.more_rows else [],
                "heads": {key: column.head for key, column in shown.items() if column.head},
                "formats": {metric: text for metric, text in formats.items() if text},
            }
    return layouts
