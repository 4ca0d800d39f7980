"""Percentiles over an ensemble of networks."""

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd

PERCENTILES = {"p25": 25.0, "p50": 50.0, "p75": 75.0}


def percentiles(table: pd.DataFrame, keys: Sequence[str], metrics: Sequence[str]) -> pd.DataFrame:
    """Percentiles of each metric over the rows that share the same keys.

    ``table``: One row per network (and per sub-key, such as a prediction time). ``keys``: Columns
    that name a group; a row with an empty key belongs to the group of that empty key. ``metrics``:
    Numerical columns. Empty cells are undefined values (a ratio without positives): they are left
    out of the percentiles. Returns long form: the keys, ``metric``, ``p25``, ``p50``, ``p75``
    (linear interpolation between order statistics) and ``networks``, the count of defined values.
    Groups are in order of first appearance, metrics in the order given. Percentiles of no value are
    empty.
    """
    missing = [name for name in (*keys, *metrics) if name not in table.columns]
    if missing:
        raise KeyError(f"the table has no column {', '.join(missing)}")
    infinite = [name for name in metrics if np.isinf(table[name].astype(np.float64)).any()]
    if infinite:
        raise ValueError(f"infinite values in column {', '.join(infinite)}")
    rows: list[dict[str, object]] = []
    for group, members in table.groupby(list(keys), dropna=False, sort=False):
        for metric in metrics:
            values = members[metric].dropna().to_numpy(dtype=np.float64)
            row: dict[str, object] = dict(zip(keys, group, strict=True))
            row["metric"] = metric
            for name, percentage in PERCENTILES.items():
                row[name] = float(np.percentile(values, percentage)) if values.size else math.nan
            row["networks"] = int(values.size)
            rows.append(row)
    result = pd.DataFrame(rows, columns=[*keys, "metric", *PERCENTILES, "networks"])
    return result.astype({key: table[key].dtype for key in keys})
