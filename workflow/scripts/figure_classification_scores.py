"""Draw precision, recall and F-score against prediction time and reservoir size."""

from typing import Any

from burstcast.figures.classification_scores import classification_scores
from burstcast.published import published_percentiles
from burstcast_workflow.figure_files import write_figure
from burstcast_workflow.job import Provenance, run_job
from burstcast_workflow.table_files import read_table


def main(inputs: Any, outputs: Any, settings: dict[str, Any], provenance: Provenance) -> None:
    """Draw the scores of one case."""
    table = read_table(inputs.percentiles)
    published = None
    if settings["published_overlay"]:
        published = published_percentiles(read_table(inputs.published), "classification")
        published = published[published["reynolds"] == settings["reynolds"]]
    figure = classification_scores(
        table[table["case"] == settings["case"]],
        settings["fixed_neurons"],
        settings["fixed_prediction_time_lt"],
        sizes_validation=settings["example_validation"],
        published=published,
    )
    write_figure(outputs, figure)


if __name__ == "__main__":
    run_job(snakemake, main)  # noqa: F821 - Snakemake puts it there
