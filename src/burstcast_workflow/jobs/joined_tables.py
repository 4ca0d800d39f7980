"""Tables of all cases: the rows of each case's below one another."""

import csv
import io
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from burstcast_workflow.harness.storage import write_text


def write_joined(
    of_cases: Iterable[str], tables: Iterable[str], settings: Mapping[str, Any]
) -> None:
    """Write tables with the rows of all cases.

    Parameters
    ----------
    of_cases
        Tables of each case.
    tables
        Files with the same names, for the rows of all cases.
    settings
        Settings of the job.
    """
    parts = list(of_cases)
    for table in map(Path, tables):
        same = [path for path in parts if Path(path).name == table.name]
        write_text(table, joined(same, settings["columns"][table.stem]))


def joined(paths: Iterable[str], columns: Iterable[str]) -> str:
    """Text of several tables as one; a column that only some of them have is empty in the others.

    Parameters
    ----------
    paths
        Tables, in the order of their rows.
    columns
        Names of all columns that they may have, in their order.
    """
    texts = [Path(path).read_text(encoding="utf-8") for path in paths]
    readers = [csv.DictReader(io.StringIO(text)) for text in texts]
    there = {name for reader in readers for name in reader.fieldnames or ()}
    whole = io.StringIO()
    names = [column for column in columns if column in there]
    writer = csv.DictWriter(whole, names, restval="", lineterminator="\n")
    writer.writeheader()
    for reader in readers:
        writer.writerows(reader)
    return whole.getvalue()
