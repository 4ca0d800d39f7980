"""Precision, recall and F-score: medians (lines) and quartiles (bands) over the networks of an
ensemble. In grey: forecasters to compare with.
"""

from matplotlib.figure import Figure

from burstcast.figures.classification_scores import classification_scores
from burstcast_workflow.harness.figures import run_figure
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.tables import read_table
from burstcast_workflow.jobs.figures import published_beside


def draw(*, percentiles: str, settings: Settings, published: str | None = None) -> Figure:
    """Draw the scores of one case."""
    table = read_table(percentiles)
    return classification_scores(
        table,
        settings["figures.fixed_neurons"],
        settings["figures.fixed_prediction_time_lt"],
        sizes_validation=settings["shown_validation"],
        published=published_beside(table, published, "classification"),
    )


if __name__ == "__main__":
    run_figure(snakemake, draw)  # noqa: F821 - Snakemake puts it there
