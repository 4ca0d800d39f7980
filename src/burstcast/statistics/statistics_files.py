"""Long-term statistics as files: histogram of the observable, and moments of the state."""

from burstcast.base.files.netcdf import Variable
from burstcast.base.files.units import COMPONENT, COMPONENT_PRODUCT, NUMBER, OBSERVABLE
from burstcast.statistics.reductions import LongTermStatistics


def statistics_variables(statistics: LongTermStatistics) -> dict[str, Variable]:
    """Variables of the file of statistics."""
    histogram, moments = statistics.histogram, statistics.moments
    return {
        "edge": Variable(("edge",), histogram.edges, OBSERVABLE, "edges of the histogram's bins"),
        "count": Variable(("bin",), histogram.counts, NUMBER, "samples of the observable"),
        "below": Variable((), histogram.below, NUMBER, "samples below the first bin"),
        "above": Variable((), histogram.above, NUMBER, "samples above the last bin"),
        "states": Variable((), moments.count, NUMBER, "states that the moments are taken over"),
        "mean": Variable(("component",), moments.mean, COMPONENT, "mean state"),
        "mean_product": Variable(
            ("component", "other_component"),
            moments.mean_product,
            COMPONENT_PRODUCT,
            "mean products of the components",
        ),
    }
