"""Long-term statistics as files: histogram of the observable, moments of the state."""

from collections.abc import Mapping
from pathlib import Path

from burstcast.files.netcdf import Variable, read_netcdf
from burstcast.files.units import COMPONENT, COMPONENT_PRODUCT, NUMBER, OBSERVABLE
from burstcast.statistics.reductions import LongTermStatistics, SeriesReductions
from burstcast_workflow.harness.storage import write_netcdf


def write_statistics(
    path: str | Path,
    statistics: LongTermStatistics,
    provenance: Mapping[str, str],
    others: Mapping[str, Variable] | None = None,
) -> None:
    """Write statistics, and other variables beside them, to a NetCDF file."""
    histogram, moments = statistics.histogram, statistics.moments
    write_netcdf(
        path,
        {
            "edge": Variable(
                ("edge",), histogram.edges, OBSERVABLE, "edges of the histogram's bins"
            ),
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
            **(others or {}),
        },
        provenance,
    )


def read_statistics(path: str | Path) -> LongTermStatistics:
    """Read statistics that `write_statistics` wrote."""
    return LongTermStatistics.from_arrays(read_netcdf(path))


def described_reductions(runs: SeriesReductions) -> dict[str, Variable]:
    """Variables of the reductions of each run, to be written beside its statistics."""
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


def read_reductions(path: str | Path) -> SeriesReductions:
    """Read reductions of runs that `described_reductions` described."""
    data = read_netcdf(path, "edge", "run_count", "run_sum", "run_product_sum")
    return SeriesReductions(
        data["edge"], data["run_count"], data["run_sum"], data["run_product_sum"]
    )
