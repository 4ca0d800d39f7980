"""Precision, recall and F-score: medians (lines) and quartiles (bands) over the networks of an
ensemble. In grey: forecasters to compare with.
"""

from matplotlib.figure import Figure

from burstcast.figures.classification_scores import classification_scores
from burstcast_workflow.harness.figures import Settings, Table, figure
from burstcast_workflow.jobs.figures import published_beside


@figure
def draw(*, percentiles: Table, settings: Settings, published: Table | None = None) -> Figure:
    """Draw the scores of one case."""
    return classification_scores(
        percentiles,
        settings["figures.fixed_neurons"],
        settings["figures.fixed_prediction_time_lt"],
        sizes_validation=settings["shown_validation"],
        published=published_beside(percentiles, published, "classification"),
    )
