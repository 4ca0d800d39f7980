"""Tables as their declarations say, which a job has among its settings.

A rule passes them (`burstcast_workflow.tables.registry.written`), so that nothing else decides
which columns a table has, and in which order.
"""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from burstcast_workflow.harness.tables import write_table

Rows = Sequence[Mapping[str, Any]]

WHOLE_NUMBERS = ("neurons", "seed")
"""Columns of whole numbers, also where some are missing."""


def write_tables(paths: Iterable[str], settings: Mapping[str, Any], **rows: Rows) -> None:
    """Write the tables of a job.

    Parameters
    ----------
    paths
        Their files, which have the names of the tables.
    settings
        Settings of the job.
    rows
        Rows of each table, by its name.

    Raises
    ------
    ValueError
        If the columns of the rows are not those that are declared; the message names them.
    """
    files = {Path(path).stem: path for path in paths}
    declared = settings["tables"]
    if set(rows) != set(declared):
        raise ValueError(f"the job writes {sorted(rows)}; its rule declares {sorted(declared)}")
    for name, found in rows.items():
        write_table(files[name], as_declared(found, declared[name]["columns"], name))


def as_declared(rows: Rows, columns: Sequence[str], name: str) -> pd.DataFrame:
    """Table with the declared columns in their order.

    Parameters
    ----------
    rows
        Values by column.
    columns
        Names; a column with an asterisk is left out where no row has a value.
    name
        Name of the table, for messages.

    Raises
    ------
    ValueError
        If rows have columns that are not declared, or none has one that is declared.
    """
    names = [column.removesuffix("*") for column in columns]
    optional = set(names) - set(columns)
    given = {column for row in rows for column in row}
    if strange := sorted(given - set(names)):
        raise ValueError(f"table {name} declares no column {', '.join(strange)}")
    table = pd.DataFrame(rows, columns=names)
    if rows:
        if lacking := [one for one in names if one not in given | optional]:
            raise ValueError(f"table {name} declares {', '.join(lacking)}, which no row has")
        table = table.drop(columns=[one for one in optional if table[one].isna().all()])
    return table.astype({one: "Int64" for one in WHOLE_NUMBERS if one in table})
