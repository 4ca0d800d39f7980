"""Long-term statistics as files: histogram of the observable, moments of the state, single runs."""

from collections.abc import Mapping
from typing import Any

from burstcast.base.files.netcdf import Variable
from burstcast.base.files.units import COMPONENT, COMPONENT_PRODUCT, NUMBER, OBSERVABLE
from burstcast.statistics.reductions import LongTermStatistics, SeriesReductions


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


def reduction_variables(runs: SeriesReductions) -> dict[str, Variable]:
    """Variables of the reductions of each run, which are beside its statistics."""
    return {
        "run_count": Variable(
            ("start", "slot"),
            runs.counts,
            NUMBER,
            "samples of each loop's observable below the first bin, in each bin, above the last",
        ),
        "run_sum": Variable(
            ("start", "component"), runs.sums, COMPONENT, "sums of each loop's state over time"
        ),
        "run_product_sum": Variable(
            ("start", "pair"),
            runs.product_sums,
            COMPONENT_PRODUCT,
            "sums of products of its components",
        ),
    }


def reductions_from(arrays: Mapping[str, Any]) -> SeriesReductions:
    """Reductions of runs from the variables of their file."""
    return SeriesReductions(
        arrays["edge"], arrays["run_count"], arrays["run_sum"], arrays["run_product_sum"]
    )
