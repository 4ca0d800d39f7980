"""Long-term statistics as files: histogram of the observable, moments of the state."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from burstcast.statistics.densities import Histogram
from burstcast.statistics.measures import nearest
from burstcast.statistics.profiles import StateMoments
from burstcast.statistics.reductions import LongTermStatistics
from burstcast_workflow.storage import Variable, read_netcdf, write_netcdf


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
            "edge": Variable(("edge",), histogram.edges, "1", "edges of the histogram's bins"),
            "count": Variable(("bin",), histogram.counts, "1", "samples of the observable"),
            "below": Variable((), histogram.below, "1", "samples below the first bin"),
            "above": Variable((), histogram.above, "1", "samples above the last bin"),
            "states": Variable((), moments.count, "1", "states that the moments are taken over"),
            "mean": Variable(("component",), moments.mean, "1", "mean state"),
            "mean_product": Variable(
                ("component", "other_component"),
                moments.mean_product,
                "1",
                "mean products of the components",
            ),
            **(others or {}),
        },
        provenance,
    )


def read_statistics(path: str | Path) -> LongTermStatistics:
    """Read statistics that `write_statistics` wrote."""
    data = read_netcdf(path)
    return LongTermStatistics(
        histogram=Histogram(
            edges=data["edge"],
            counts=data["count"],
            below=int(data["below"]),
            above=int(data["above"]),
        ),
        moments=StateMoments(
            count=int(data["states"]), mean=data["mean"], mean_product=data["mean_product"]
        ),
    )


@dataclass(frozen=True)
class BestNetwork:
    """The network whose statistics are nearest to the data's, of those that are compared.

    Attributes
    ----------
    statistics
        Its statistics.
    label
        What figures call it.
    """

    statistics: LongTermStatistics
    label: str


def best_network(
    data: LongTermStatistics, keys: Sequence[Mapping[str, Any]], paths: Sequence[str]
) -> BestNetwork | None:
    """Network with the smallest Kantorovich metric; None if none has any statistics.

    Parameters
    ----------
    data
        Statistics of the data.
    keys
        Of networks of one size, ``neurons`` and ``seed`` among them.
    paths
        Files of their statistics.
    """
    networks = [read_statistics(path) for path in paths]
    best = nearest(data, networks)
    if best is None:
        return None
    which = f"best of {len(keys)}: " if len(keys) > 1 else ""
    label = f"ESN ({keys[best]['neurons']} neurons, {which}seed {keys[best]['seed']})"
    return BestNetwork(networks[best], label)
