"""Mean prediction horizon of extreme events against reservoir size: medians (lines) and quartiles
(bands) over the networks of an ensemble. Thin bars: the bootstrap interval of one network's mean
over the events, in the median. In grey: forecasters to compare with.
"""

from matplotlib.figure import Figure

from burstcast.figures.horizon_by_size import horizon_by_size
from burstcast_workflow.harness.figures import run_figure
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.tables import read_table
from burstcast_workflow.jobs.figures import published_beside


def draw(
    *, percentiles: str, intervals: str, settings: Settings, published: str | None = None
) -> Figure:
    """Draw the horizons of one case."""
    table = read_table(percentiles)
    return horizon_by_size(
        table,
        read_table(intervals),
        published=published_beside(table, published, "horizon"),
    )


if __name__ == "__main__":
    run_figure(snakemake, draw)  # noqa: F821 - Snakemake puts it there
