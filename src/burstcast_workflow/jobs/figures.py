"""What figures of percentiles take from their tables."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from burstcast.published import published_percentiles
from burstcast_workflow.harness.tables import read_table

Settings = Mapping[str, Any]


def of_case(settings: Settings, percentiles: str) -> pd.DataFrame:
    """Rows of a table that belong to the case that a figure shows."""
    table = read_table(percentiles)
    shown: pd.DataFrame = table.loc[table["case"] == settings["shown_case"]]
    return shown


def of_data(settings: Settings, table: str) -> pd.DataFrame:
    """Rows of a table that belong to the data of the case that a figure shows."""
    rows = of_case(settings, table)
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
