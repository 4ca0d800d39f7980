"""Typeset a table for papers in LaTeX: one table for each case."""

from burstcast.typesetting import to_latex
from burstcast_workflow.harness.job import run_job
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.storage import write_text
from burstcast_workflow.harness.tables import read_table
from burstcast_workflow.jobs.wide_tables import wide_tables
from burstcast_workflow.table_texts import LAYOUTS, head, latex_caption


def typeset(*, table: str, latex: str, settings: Settings) -> None:
    """Write table environments with booktabs rules."""
    name, rows = settings["table"], read_table(table)
    if name not in LAYOUTS:  # its cells are LaTeX already; some parameters have no symbol
        text = to_latex(rows.fillna(""), latex_caption(name), f"tab:{name}", keys=2)
    else:
        text = "\n".join(
            to_latex(
                cells,
                f"{title}: {latex_caption(name)}" if title else latex_caption(name),
                f"tab:{name}" + (f":{title}" if title else ""),
                heads={column: head(column) for column in cells.columns},
                keys=keys,
            )
            for title, cells, keys in wide_tables(rows, LAYOUTS[name])
        )
    write_text(latex, text)


if __name__ == "__main__":
    run_job(snakemake, typeset)  # noqa: F821 - Snakemake puts it there
