"""Draw the mean prediction horizon of extreme events against reservoir size."""

from typing import Any

from burstcast.figures.horizon_by_size import horizon_by_size
from burstcast.published import published_percentiles
from burstcast_workflow.figure_files import write_figure
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.table_files import read_table


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Draw the horizons of one case."""
    table = read_table(inputs.percentiles)
    published = None
    if settings["published_overlay"]:
        published = published_percentiles(read_table(inputs.published), "horizon")
        published = published[published["reynolds"] == settings["reynolds"]]
    figure = horizon_by_size(table[table["case"] == settings["case"]], published=published)
    write_figure(outputs, figure)


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
