"""Tables: what they are made of, their columns as declared, and percentiles over networks."""

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from burstcast.tables.makers.registry import Gathered
from burstcast_workflow.harness.settings import JobSettings, at
from burstcast_workflow.harness.storage import write_table
from burstcast_workflow.jobs.inputs import content
from burstcast_workflow.jobs.origins import origins

if TYPE_CHECKING:
    import pandas as pd

Rows = Sequence[Mapping[str, Any]]

WHOLE_NUMBERS = ("neurons", "seed")
"""Columns of whole numbers, also where some are missing."""


class Tables(JobSettings):
    """Declarations of the tables that a job writes, by their names."""

    tables: dict[str, dict[str, Any]] = at("tables")

    def write(self, paths: Iterable[str], **rows: Rows) -> None:
        """Write tables, given by name, and the percentiles over networks that they declare."""
        from burstcast.tables.percentiles import percentiles  # loads pandas

        files = {Path(path).stem: path for path in paths}
        if set(rows) != set(self.tables):
            wanted = sorted(self.tables)
            raise ValueError(f"the job writes {sorted(rows)}; its rule declares {wanted}")
        for name, table_rows in rows.items():
            declared = self.tables[name]
            metrics_declared = declared.get("metrics", [])
            if metrics_declared and (
                strange := sorted({row["metric"] for row in table_rows} - set(metrics_declared))
            ):
                raise ValueError(f"table {name} declares no metric {', '.join(strange)}")
            table = write_table(files[name], as_declared(table_rows, declared["columns"], name))
            if "percentiles" in declared:
                keys = [column for column in declared["by"] if column in table]
                metrics = [column for column in declared["percentiles"] if column in table]
                write_table(files[f"{name}_percentiles"], percentiles(table, keys, metrics))


class TablesOfCase(Tables):
    """Tables of a case; their makers declare further settings."""

    parameters: dict[str, Any] = at("case.parameters")

    def gathered(self, paths: Iterable[str | Path], variables: str = "") -> list[Gathered]:
        """Files of the case for tables."""
        files = origins(paths)
        for file in files:
            if file.identity["case"] != self.case:
                other = file.identity["case"]
                raise ValueError(f"{file.path} is of the case {other}, which is another")
        contents = [content(file.path, variables) for file in files]
        return [
            Gathered(file.name, each, json.loads(each.get("plan", "{}")))
            for file, each in zip(files, contents, strict=True)
        ]

    def with_keys(self, rows: Mapping[str, Rows]) -> dict[str, Rows]:
        """Rows of tables with the key columns of the case that the tables declare."""
        completed: dict[str, Rows] = {}
        of_case = {"case": self.case, "reynolds": self.parameters.get("reynolds")}
        for name, table_rows in rows.items():
            columns = {column.removesuffix("*") for column in self.tables[name]["columns"]}
            keys = {key: value for key, value in of_case.items() if key in columns}
            completed[name] = [{**keys, **row} for row in table_rows]
        return completed


def as_declared(rows: Rows, columns: Sequence[str], name: str) -> "pd.DataFrame":
    """Table with the declared columns in their order; columns with an asterisk need no value."""
    import pandas as pd  # jobs from the cache start without it

    names = [column.removesuffix("*") for column in columns]
    optional = set(names) - set(columns)
    given = {column for row in rows for column in row}
    if strange := sorted(given - set(names)):
        raise ValueError(f"table {name} declares no column {', '.join(strange)}")
    table = pd.DataFrame(rows, columns=names)
    if rows:
        if lacking := [column for column in names if column not in given | optional]:
            raise ValueError(f"table {name} declares {', '.join(lacking)}, which no row has")
        table = table.drop(columns=[column for column in optional if table[column].isna().all()])
    return table.astype({column: "Int64" for column in WHOLE_NUMBERS if column in table})
