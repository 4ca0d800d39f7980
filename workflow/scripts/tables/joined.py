"""Put the tables of all cases below one another, and typeset some of them for papers."""

from pathlib import Path
from typing import Any

from burstcast.base.files.tables import read_table
from burstcast.base.names import KEYS
from burstcast.tables.joined import joined_tables
from burstcast_workflow.harness.job import JobSettings, at, job, write_text


class Joined(JobSettings):
    """Columns by the name of the table, layouts by the name of the LaTeX file."""

    columns: dict[str, list[str]] = at("columns")
    latex: dict[str, dict[str, Any]] = at("latex")


@job
def join(*, of_cases: list[str], tables: list[str], latex: list[str], settings: Joined) -> None:
    """Write the rows of all cases, by table, and the LaTeX that is made of them."""
    from burstcast.tables.wide import typeset  # with pandas: jobs from the cache start without

    files = {Path(file).name: file for file in [*tables, *latex]}
    for name, text in joined_tables(of_cases, settings.columns).items():
        write_text(files[f"{name}.csv"], text)
    for name, layout in settings.latex.items():
        rows = read_table(files[f"{layout['source']}.csv"])
        write_text(files[f"{name}.tex"], typeset(name, rows, layout, KEYS))
