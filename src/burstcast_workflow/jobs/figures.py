"""What several figures need of a job's settings and files."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from burstcast.published import published_percentiles
from burstcast.statistics.measures import BestNetwork, best_network
from burstcast.statistics.reductions import LongTermStatistics
from burstcast_workflow.harness.tables import read_table
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


def of_case(settings: Settings, percentiles: str) -> pd.DataFrame:
    """Rows of a table that belong to the case that a figure shows."""
    table = read_table(percentiles)
    shown: pd.DataFrame = table.loc[table["case"] == settings["shown_case"]]
    return shown


def published_beside(table: pd.DataFrame, published: str | None, name: str) -> pd.DataFrame | None:
    """Published percentiles at the Reynolds number of a case; None where they are not drawn.

    Parameters
    ----------
    table
        Rows of the case.
    published
        The file, if the job has it as an input.
    name
        Of the table.
    """
    if published is None:
        return None
    values = published_percentiles(read_table(published), name)
    shown: pd.DataFrame = values.loc[values["reynolds"].isin(table["reynolds"])]
    return shown
