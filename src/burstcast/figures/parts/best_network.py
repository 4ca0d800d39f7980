"""The network that a figure shows where it can only show one."""

from collections.abc import Mapping, Sequence
from typing import Any

from burstcast.statistics.measures import BestNetwork, best_network
from burstcast.statistics.reductions import LongTermStatistics


def best_of(data: Mapping[str, Any], long_term: Sequence[Mapping[str, Any]]) -> BestNetwork | None:
    """Network whose long-term statistics are nearest to the data's; None if none has any.

    ``data``: File of the data's statistics (`LongTermStatistics.from_arrays`). ``long_term``: Files
    of the networks' statistics; each says its ``neurons`` and ``seed``.
    """
    statistics = {
        (file["neurons"], file["seed"]): LongTermStatistics.from_arrays(file) for file in long_term
    }
    return best_network(LongTermStatistics.from_arrays(data), statistics)
