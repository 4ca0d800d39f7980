"""The network that stands for all where a figure can only show one."""

from collections.abc import Mapping, Sequence
from typing import Any

from burstcast.statistics.measures import BestNetwork, best_network
from burstcast.statistics.reductions import LongTermStatistics


def best_of(
    data: Mapping[str, Any],
    long_term: Sequence[Mapping[str, Any]],
    networks: Sequence[Mapping[str, Any]],
) -> BestNetwork | None:
    """Network whose long-term statistics are nearest to the data's; None if none has any.

    Parameters
    ----------
    data
        File of the data's statistics (`LongTermStatistics.from_arrays`).
    long_term
        Files of the networks' statistics, in any order; each says its ``forecaster``.
    networks
        Each network's ``identity``, with its ``forecaster``, and ``keys``, with its ``neurons``
        and ``seed``.
    """
    files = {file["forecaster"]: file for file in long_term}
    statistics = {
        (one["keys"]["neurons"], one["keys"]["seed"]): LongTermStatistics.from_arrays(
            files[one["identity"]["forecaster"]]
        )
        for one in networks
    }
    return best_network(LongTermStatistics.from_arrays(data), statistics)
