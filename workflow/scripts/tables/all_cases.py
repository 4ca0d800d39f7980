"""Put the tables of all cases below one another."""

import csv
import io
from collections.abc import Iterable
from pathlib import Path

from burstcast_workflow.harness.job import run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import write_text


def join(*, tables: list[str], table: str, settings: Settings) -> None:
    """Write the rows of all cases; a column that a case does not have is empty there."""
    rows: list[dict[str, str]] = []
    columns: list[str] = []
    for path in tables:
        reader = csv.DictReader(io.StringIO(Path(path).read_text(encoding="utf-8")))
        columns = in_one_order(columns, reader.fieldnames or ())
        rows += reader
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    write_text(table, text.getvalue())


def in_one_order(columns: Iterable[str], more: Iterable[str]) -> list[str]:
    """All of both; what is new comes behind its neighbour, so that settings stay among settings."""
    found = list(columns)
    place = 0
    for name in more:
        if name not in found:
            found.insert(place, name)
        place = found.index(name) + 1
    return found


if __name__ == "__main__":
    run_job(snakemake, join)  # noqa: F821 - Snakemake puts it there
