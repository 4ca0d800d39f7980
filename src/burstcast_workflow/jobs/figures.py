"""What figures of percentiles take from their tables."""

from collections.abc import Iterable

import pandas as pd

from burstcast.published import published_percentiles
from burstcast_workflow.harness.tables import read_table


def of_cases(tables: Iterable[str]) -> pd.DataFrame:
    """The rows of the tables of several cases."""
    return pd.concat(map(read_table, tables), ignore_index=True)


def of_data(table: str) -> pd.DataFrame:
    """Rows of a case's table that belong to the data."""
    rows = read_table(table)
    data: pd.DataFrame = rows.loc[rows["forecaster"] == "data"]
    return data


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
