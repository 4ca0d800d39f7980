"""Typeset a table in LaTeX."""

from typing import Any

from burstcast.tables import to_latex
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.storage import write_text
from burstcast_workflow.table_files import read_table
from burstcast_workflow.table_layouts import CAPTIONS, FORMATS, PARAMETER_TABLES, head

PERCENTILES = "Percentiles over the networks of an ensemble."


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Write a table environment with booktabs rules."""
    name, table = settings["table"], read_table(inputs.table)
    results = name.removesuffix("_percentiles")
    caption = CAPTIONS[results] if name == results else f"{CAPTIONS[results]} {PERCENTILES}"
    verbatim = []
    if name in PARAMETER_TABLES:
        verbatim = list(table.columns)
        # some parameters have no symbol
        table["Parameter"] = table["Parameter"].fillna("")
    elif "metric" in table:
        table["metric"] = table["metric"].map(head)
        verbatim = ["metric"]
    latex = to_latex(
        table,
        caption,
        f"tab:{name}",
        headers={column: head(column) for column in table},
        formats={column: FORMATS[column] for column in table if column in FORMATS},
        verbatim=verbatim,
    )
    write_text(outputs.latex, latex)


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
