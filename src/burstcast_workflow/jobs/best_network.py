"""The network that stands for all where a figure can only show one."""

from collections.abc import Mapping, Sequence
from typing import Any

from burstcast.statistics.measures import BestNetwork, best_network
from burstcast.statistics.reductions import LongTermStatistics
from burstcast_workflow.jobs.gather import gathered
from burstcast_workflow.jobs.statistics_files import read_statistics

Settings = Mapping[str, Any]


def best_of(
    settings: Settings, data: LongTermStatistics, long_term: Sequence[str]
) -> BestNetwork | None:
    """The network whose statistics are nearest to the data's; None if none has any."""
    networks = {
        (record["keys"]["neurons"], record["keys"]["seed"]): read_statistics(path)
        for record, path in gathered(settings["rows"], long_term)
    }
    return best_network(data, networks)
