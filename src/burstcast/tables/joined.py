"""Tables of several parts: the rows of each below one another."""

import csv
import io
from collections.abc import Iterable, Mapping
from pathlib import Path


def joined_tables(
    parts: Iterable[str | Path], columns: Mapping[str, Iterable[str]]
) -> dict[str, str]:
    """Texts of tables by their names; the files of their parts have the same names.

    ``parts``: Files of comma-separated values, in the order of their rows. ``columns``: Names of
    all columns that a table may have, in their order, by the name of the table.
    """
    paths = [Path(part) for part in parts]
    return {
        name: joined(
            [path.read_text(encoding="utf-8") for path in paths if path.stem == name], all_
        )
        for name, all_ in columns.items()
    }


def joined(texts: Iterable[str], columns: Iterable[str]) -> str:
    """Text of several tables as one; columns that a table lacks are empty in its rows.

    ``texts``: Tables as comma-separated values, in the order of their rows. ``columns``: Names of
    all columns that they may have, in their order.
    """
    readers = [csv.DictReader(io.StringIO(text)) for text in texts]
    there = {name for reader in readers for name in reader.fieldnames or ()}
    whole = io.StringIO()
    names = [column for column in columns if column in there]
    writer = csv.DictWriter(whole, names, restval="", lineterminator="\n")
    writer.writeheader()
    for reader in readers:
        writer.writerows(reader)
    return whole.getvalue()
