"""Mean prediction horizon of extreme events against reservoir size: medians (lines) and quartiles
(bands) over the networks of an ensemble. Thin bars: the bootstrap interval of one network's mean
over the events, in the median. In grey: forecasters to compare with.
"""

from matplotlib.figure import Figure

from burstcast.figures.horizon_by_size import horizon_by_size
from burstcast_workflow.harness.figures import Settings, Table, figure
from burstcast_workflow.jobs.figures import published_beside


@figure
def draw(
    *, percentiles: Table, intervals: Table, settings: Settings, published: Table | None = None
) -> Figure:
    """Draw the horizons of one case."""
    return horizon_by_size(
        percentiles, intervals, published=published_beside(percentiles, published, "horizon")
    )
