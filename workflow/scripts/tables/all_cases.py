"""Put the tables of all cases below one another."""

from pathlib import Path

from burstcast.tables.joined import joined_tables
from burstcast_workflow.harness.job import JobSettings, at, job, write_text


class Joined(JobSettings):
    """Columns by the name of the table."""

    columns: dict[str, list[str]] = at("columns")


@job
def join(*, of_cases: list[str], tables: list[str], settings: Joined) -> None:
    """Write the rows of all cases."""
    files = {Path(table).stem: table for table in tables}
    for name, text in joined_tables(of_cases, settings.columns).items():
        write_text(files[name], text)
