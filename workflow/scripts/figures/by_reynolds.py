"""(a) Mean prediction horizon of extreme events and (b, ...) F-score some time ahead, against the
Reynolds number; last row: F-score against prediction time, a panel for each validation strategy.
Medians and quartiles over the networks of an ensemble.
"""

from matplotlib.figure import Figure

from burstcast.figures.by_reynolds import by_reynolds
from burstcast_workflow.harness.figures import Settings, Table, figure
from burstcast_workflow.jobs.figures import OfCases, published_of


@figure
def draw(
    *, horizons: OfCases, scores: OfCases, settings: Settings, published: Table | None = None
) -> Figure:
    """Draw the networks of one size."""
    return by_reynolds(
        horizons,
        scores,
        settings["figures.fixed_neurons"],
        settings["figures.reynolds_prediction_times_lt"],
        published_horizon=published_of(published, "horizon"),
        published_classification=published_of(published, "classification"),
    )
