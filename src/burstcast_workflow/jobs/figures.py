"""What figures take from their inputs."""

from collections.abc import Iterable
from typing import Annotated

import pandas as pd

from burstcast.published import published_percentiles
from burstcast.statistics.reductions import LongTermStatistics
from burstcast_workflow.harness.tables import read_table
from burstcast_workflow.jobs.statistics_files import read_statistics


def of_cases(tables: Iterable[str]) -> pd.DataFrame:
    """The rows of the tables of several cases."""
    return pd.concat(map(read_table, tables), ignore_index=True)


def of_data(table: str) -> pd.DataFrame:
    """Rows of a case's table that belong to the data."""
    rows = read_table(table)
    data: pd.DataFrame = rows.loc[rows["forecaster"] == "data"]
    return data


OfCases = Annotated[pd.DataFrame, of_cases]
OfData = Annotated[pd.DataFrame, of_data]
Statistics = Annotated[LongTermStatistics, read_statistics]
"""Inputs of figures that are read so."""


def published_of(published: pd.DataFrame | None, name: str) -> pd.DataFrame | None:
    """Published percentiles of a table; None where the figure has none as an input."""
    return None if published is None else published_percentiles(published, name)


def published_beside(
    table: pd.DataFrame, published: pd.DataFrame | None, name: str
) -> pd.DataFrame | None:
    """Those of them at the Reynolds number of the case that the rows of ``table`` are of."""
    values = published_of(published, name)
    if values is None or "reynolds" not in table:  # as of a system without one
        return None
    return values.loc[values["reynolds"].isin(table["reynolds"])]
