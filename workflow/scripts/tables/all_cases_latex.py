"""Put the tables of all cases below one another, and typeset them for papers."""

from pathlib import Path

from burstcast_workflow.harness.job import job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import write_text
from burstcast_workflow.harness.tables import read_table
from burstcast_workflow.jobs.joined_tables import write_joined
from burstcast_workflow.jobs.wide_tables import typeset


@job
def join_and_typeset(
    *, of_cases: list[str], tables: list[str], latex: list[str], settings: Settings
) -> None:
    """Write the rows of all cases, and the LaTeX that is made of them."""
    write_joined(of_cases, tables, settings)
    files = {Path(table).stem: table for table in tables}
    for path in latex:
        layout = settings["latex"][Path(path).stem]
        rows = read_table(files[layout["source"]])
        write_text(path, typeset(Path(path).stem, rows, layout))
