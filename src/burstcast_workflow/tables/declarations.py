"""Tables, columns and sections of the report, as ``workflow/tables.yaml`` declares them."""

from dataclasses import field
from typing import Annotated, Any

import yaml
from pydantic import BeforeValidator, ConfigDict, TypeAdapter
from pydantic.dataclasses import dataclass

from burstcast.base.discovery import suggestion
from burstcast.base.names import KEYS
from burstcast_workflow.project import project_root

OPTIONAL = "*"
"""Mark behind the name of a column that is left out where no row has a value."""

_FORECASTER = [f"{key}{OPTIONAL if key == 'reynolds' else ''}" for key in KEYS]
ENSEMBLE = _FORECASTER[:-1]
"""Key columns of an ensemble of networks: all keys but the seed."""

PERCENTILES = ["metric", "p25", "p50", "p75", "networks"]
"""Columns of percentiles over networks, after the keys."""


def _flat(names: list[Any]) -> list[str]:
    """Names, some of which are lists that stand elsewhere in the file, too."""
    flat: list[str] = []
    for name in names:
        flat += name if isinstance(name, list) else [name]
    return flat


Names = Annotated[list[str], BeforeValidator(_flat)]
_STRICT = ConfigDict(extra="forbid")


@dataclass(frozen=True, config=_STRICT)
class Column:
    """A column of tables, or a metric."""

    meaning: str
    unit: str = ""
    format: str = ""
    head: str = ""


@dataclass(frozen=True, config=_STRICT)
class Layout:
    """A table for papers."""

    caption: str
    metrics: Names = field(default_factory=list)
    columns: str = "metric"
    more_rows: Names = field(default_factory=list)
    where: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True, config=_STRICT)
class Table:
    """A table."""

    description: str
    section: str
    script: str
    columns: Names
    metrics: Names = field(default_factory=list)
    keys: Names = field(default_factory=lambda: _FORECASTER)
    rows_of: str = "case_names"
    of_cases: bool = True
    percentiles: Names = field(default_factory=list)
    group_by: Names = field(default_factory=list)
    latex: dict[str, Layout] = field(default_factory=dict)
    redefined: dict[str, Column] = field(default_factory=dict)


with (project_root() / "workflow" / "tables.yaml").open(encoding="utf-8") as _file:
    # libyaml's loader, where there is one, takes a tenth of the time
    _read = yaml.load(_file, getattr(yaml, "CSafeLoader", yaml.SafeLoader))
SECTIONS = {
    name: f"{number} {title}" for number, (name, title) in enumerate(_read["sections"].items(), 1)
}
"""Numbered titles of the report's sections, by the names that figures and tables declare."""

COLUMNS = TypeAdapter(dict[str, Column]).validate_python(_read["columns"])
TABLES = TypeAdapter(dict[str, Table]).validate_python(_read["tables"])
"""Columns and metrics, and tables, by name; tables in the order of the report."""


def _check(name: str, table: Table) -> None:
    """Check the words of a table that name something else."""
    columns = [column.removesuffix(OPTIONAL) for column in (*table.keys, *table.columns)]
    for noun, values, allowed in (
        ("section", [table.section], SECTIONS),
        ("column", columns, {**COLUMNS, **table.redefined}),
        ("metric", [*table.metrics, *table.percentiles], {**COLUMNS, **table.redefined}),
    ):
        for value in values:
            if value not in allowed:
                raise ValueError(
                    f"workflow/tables.yaml: the table {name} has the {noun} {value!r}, which is "
                    f"declared nowhere{suggestion(value, allowed)}"
                )


for _name, _table in TABLES.items():
    _check(_name, _table)
