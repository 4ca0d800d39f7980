"""From rows of a table to what stands on paper: who as rows, what is known of them as columns."""

from collections.abc import Iterator, Mapping
from typing import Any

import pandas as pd

from burstcast.tables import escape
from burstcast.typesetting import wide_table
from burstcast_workflow.control_plans import CONDITIONS
from burstcast_workflow.identifiers import KEYS
from burstcast_workflow.table_texts import FORMATS, Layout

WHO = "forecaster"
PERCENTILES, INTERVAL = ("p50", "p25", "p75"), ("value", "low", "high")


def wide_tables(rows: pd.DataFrame, layout: Layout) -> Iterator[tuple[str, pd.DataFrame, int]]:
    """Tables for papers, made of the rows of a table.

    Parameters
    ----------
    rows
        Of all cases.
    layout
        What is shown of them.

    Yields
    ------
    Case (empty where cases are rows of one table), texts in LaTeX, and how many of the columns, the
    first ones, tell rows apart.
    """
    chosen = rows if "metric" in rows.columns else _long_form(rows, layout.metrics)
    chosen = chosen[chosen["metric"].isin(layout.metrics)]
    for column, value in layout.where.items():
        chosen = chosen[chosen[column] == value]
    if "forecaster" not in chosen.columns:  # a row for each case
        yield "", wide_table(chosen, ["case"], layout.columns, specs=FORMATS), 1
        return
    if "seed" in chosen.columns and "seed" not in layout.more_rows:
        chosen = chosen[chosen["seed"].isna()]  # single networks stand in the raw table
    if layout.columns == "prediction_time_lt":
        whole = chosen[layout.columns] % 1 == 0
        chosen = chosen[whole] if whole.any() else chosen
    interval = PERCENTILES if "p50" in chosen.columns else INTERVAL
    for case, of_case in chosen.groupby("case", sort=False):
        keys = [WHO, *layout.more_rows]  # seeds only where the case has networks
        named = of_case.assign(**{WHO: [_who(row) for row in of_case.to_dict("records")]})
        if "strategy" in keys:
            named["strategy"] = _plans(named)
        for key in keys:
            named[key] = named[key].map(lambda value: "" if pd.isna(value) else _shown(value))
        if "seed" in keys and (named["seed"] == "").all():
            keys = [key for key in keys if key != "seed"]
        cells = wide_table(named, keys, layout.columns, interval=interval, specs=FORMATS)
        cells[keys] = cells[keys].map(escape)
        cells = cells.rename(columns={name: _shown(name) for name in cells.columns})
        yield str(case), cells, len(keys)


def _long_form(rows: pd.DataFrame, metrics: tuple[str, ...]) -> pd.DataFrame:
    """A row for each metric, with the interval that columns of its name with an ending hold."""
    keys = [key for key in KEYS if key in rows.columns]
    return pd.concat(
        [
            rows[keys].assign(
                metric=metric,
                value=rows[metric],
                low=rows.get(f"{metric}_low", float("nan")),
                high=rows.get(f"{metric}_high", float("nan")),
            )
            for metric in metrics
            if metric in rows.columns  # a table has no column of what nobody knows
        ],
        ignore_index=True,
    )


def _who(row: Mapping[Any, Any]) -> str:
    parts = (row.get(name) for name in ("forecaster", "neurons", "validation"))
    return " ".join(str(part) for part in parts if not pd.isna(part))


def _shown(value: Any) -> str:
    return f"{value:g}" if isinstance(value, int | float) else str(value)


def _plans(rows: pd.DataFrame) -> list[str]:
    """Strategies of control with those settings and conditions that tell some of them apart."""
    names = list(rows.columns)
    settings = [
        name
        for name in names[names.index("strategy") + 1 : names.index("metric")]
        if name not in CONDITIONS or rows[name].nunique(dropna=False) > 1
    ]
    return [
        f"{row['strategy'].replace('_', ' ')} "
        f"({', '.join(_shown(row[name]) for name in settings if not pd.isna(row[name]))})"
        for row in rows.to_dict("records")
    ]
