"""Draw what control achieves against how early it acts and how much it acts."""

from typing import Any

from burstcast.figures.control_tradeoff import control_tradeoff
from burstcast_workflow.figure_files import write_figure
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.table_files import read_table


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Draw the networks of one kind, and the forecasters to compare them with."""
    table = read_table(inputs.percentiles)
    of_kind = (table["neurons"] == settings["neurons"]) & (
        table["validation"] == settings["validation"]
    )
    shown = (table["case"] == settings["case"]) & (table["neurons"].isna() | of_kind)
    write_figure(outputs, control_tradeoff(table[shown], symbol=settings["symbol"]))


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
