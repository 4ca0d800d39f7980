"""Typeset a table in LaTeX."""

from burstcast.tables import to_latex
from burstcast_workflow.harness.job import run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import write_text
from burstcast_workflow.harness.tables import read_table
from burstcast_workflow.table_texts import CAPTIONS, FORMATS, OWN_FORMATS, PARAMETER_TABLES, head

PERCENTILES = "Percentiles over the networks of an ensemble."


def typeset(*, table: str, latex: str, settings: Settings) -> None:
    """Write a table environment with booktabs rules."""
    name, cells = settings["table"], read_table(table)
    if "reynolds" in cells and cells["reynolds"].isna().all():
        del cells["reynolds"]  # no case has one
    columns = [str(column) for column in cells.columns]
    results = name.removesuffix("_percentiles")
    caption = CAPTIONS[results] if name == results else f"{CAPTIONS[results]} {PERCENTILES}"
    formats = {**FORMATS, **OWN_FORMATS.get(name, {})}
    verbatim = []
    if name in PARAMETER_TABLES:
        verbatim = columns
        # some parameters have no symbol
        cells["Parameter"] = cells["Parameter"].fillna("")
    elif "metric" in columns:
        cells["metric"] = cells["metric"].map(head)
        verbatim = ["metric"]
    text = to_latex(
        cells,
        caption,
        f"tab:{name}",
        headers={column: head(column) for column in columns},
        formats={column: formats[column] for column in columns if column in formats},
        verbatim=verbatim,
    )
    write_text(latex, text)


if __name__ == "__main__":
    run_job(snakemake, typeset)  # noqa: F821 - Snakemake puts it there
