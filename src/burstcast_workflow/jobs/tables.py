"""Tables as declared: columns, cells with intervals, percentiles over networks."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd

from burstcast.arrays import FloatArray
from burstcast.statistics.percentiles import percentiles
from burstcast.statistics.resampled_score import ResampledScore, median_scores
from burstcast.statistics.resampling import percentile_interval
from burstcast_workflow.campaign.identifiers import ForecasterName
from burstcast_workflow.harness.settings import Settings
from burstcast_workflow.harness.tables import write_table

Rows = Sequence[Mapping[str, Any]]
Scores = Mapping[str, ResampledScore]

WHOLE_NUMBERS = ("neurons", "seed")
"""Columns of whole numbers, also where some are missing."""


def write_tables(paths: Iterable[str], settings: Settings, **rows: Rows) -> None:
    """Write the tables of a job, and the percentiles over networks that they declare.

    Parameters
    ----------
    paths
        Their files, which have the names of the tables and of the percentiles.
    settings
        Settings of the job.
    rows
        Rows of each table, by its name.

    Raises
    ------
    ValueError
        If the columns of the rows are not those that are declared; the message names them.
    """
    files = {Path(path).stem: path for path in paths}
    declared = settings["tables"]
    if set(rows) != set(declared):
        raise ValueError(f"the job writes {sorted(rows)}; its rule declares {sorted(declared)}")
    for name, found in rows.items():
        table = write_table(files[name], as_declared(found, declared[name]["columns"], name))
        if "percentiles" in declared[name]:
            keys, metrics = (
                [column for column in declared[name][names] if column in table]
                for names in ("by", "percentiles")
            )
            write_table(files[f"{name}_percentiles"], percentiles(table, keys, metrics))


def as_declared(rows: Rows, columns: Sequence[str], name: str) -> pd.DataFrame:
    """Table with the declared columns in their order.

    Parameters
    ----------
    rows
        Values by column.
    columns
        Names; a column with an asterisk is left out where no row has a value.
    name
        Name of the table, for messages.

    Raises
    ------
    ValueError
        If rows have columns that are not declared, or none has one that is declared.
    """
    names = [column.removesuffix("*") for column in columns]
    optional = set(names) - set(columns)
    given = {column for row in rows for column in row}
    if strange := sorted(given - set(names)):
        raise ValueError(f"table {name} declares no column {', '.join(strange)}")
    table = pd.DataFrame(rows, columns=names)
    if rows:
        if lacking := [one for one in names if one not in given | optional]:
            raise ValueError(f"table {name} declares {', '.join(lacking)}, which no row has")
        table = table.drop(columns=[one for one in optional if table[one].isna().all()])
    return table.astype({one: "Int64" for one in WHOLE_NUMBERS if one in table})


def between(samples: FloatArray, confidence: float) -> dict[str, float]:
    """Both ends of the interval that resamples of a score tell."""
    low, high = percentile_interval(samples, confidence)
    return {"low": low, "high": high}


def with_interval(score: ResampledScore, confidence: float) -> dict[str, float]:
    """A score, and `between`."""
    return {"value": float(score.value), **between(score.samples, confidence)}


def with_ends(name: str, value: Any, low: Any, high: Any) -> dict[str, Any]:
    """A value in the column of its name, and the ends of its interval in columns beside it."""
    return {name: value, f"{name}_low": low, f"{name}_high": high}


def medians_over_seeds(found: Iterable[tuple[Mapping[str, Any], Scores]]) -> dict[str, Scores]:
    """Scores by who they are of, where networks that differ by their seeds are one.

    Parameters
    ----------
    found
        Key columns of forecasters and their scores by name.

    Returns
    -------
    By identifier, in the order in which they come; "median of" networks by what these share.
    """
    alike: dict[ForecasterName, list[tuple[str, Scores]]] = {}
    for keys, scores in found:
        common = ForecasterName(keys["forecaster"], keys["neurons"], keys["validation"])
        identifier = replace(common, seed=keys["seed"]).identifier
        alike.setdefault(common, []).append((identifier, scores))
    return dict(
        members[0]
        if len(members) == 1
        else (f"median of {common.identifier}", median_scores([scores for _, scores in members]))
        for common, members in alike.items()
    )
