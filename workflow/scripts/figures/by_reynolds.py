"""Mean prediction horizon of extreme events and F-score against the Reynolds number: medians and
quartiles over the networks of an ensemble.
"""

from matplotlib.figure import Figure

from burstcast.figures.by_reynolds import by_reynolds
from burstcast.published import published_percentiles
from burstcast_workflow.harness.figures import run_figure
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.tables import read_table
from burstcast_workflow.jobs.figures import of_cases


def draw(
    *, horizons: list[str], scores: list[str], settings: Settings, published: str | None = None
) -> Figure:
    """Draw the networks of one size."""
    values = None if published is None else read_table(published)
    return by_reynolds(
        of_cases(horizons),
        of_cases(scores),
        settings["figures.fixed_neurons"],
        settings["figures.reynolds_prediction_times_lt"],
        published_horizon=None if values is None else published_percentiles(values, "horizon"),
        published_classification=(
            None if values is None else published_percentiles(values, "classification")
        ),
    )


if __name__ == "__main__":
    run_figure(snakemake, draw)  # noqa: F821 - Snakemake puts it there
