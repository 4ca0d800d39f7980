"""Tables for papers in LaTeX: forecasters as rows, metrics or values of a key as columns.

A layout says what is shown of a table, and how: its caption, metrics, columns, more_rows, where,
conditions, heads and formats. Cells are values with intervals: "0.818 (0.815 to 0.824)".
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from burstcast.forecasters._labels import forecaster_label
from burstcast.tables.latex import escape, latex_number, to_latex

Layout = Mapping[str, Any]

PERCENTILES, INTERVAL = ("p50", "p25", "p75"), ("value", "low", "high")


def typeset(name: str, rows: pd.DataFrame, layout: Layout, keys: Sequence[str]) -> str:
    """Table environments with booktabs rules: one table, or one for each case.

    ``rows``: Rows of all cases of the table that it is made of.
    """
    return "\n".join(
        to_latex(
            cells,
            f"{case}: {layout['caption']}" if case else layout["caption"],
            f"tab:{name}:{case}" if case else f"tab:{name}",
            heads={
                column: layout["heads"].get(column, escape(column.replace("_", " ")))
                for column in cells.columns
            },
            keys=count,
        )
        for case, cells, count in wide_tables(rows, layout, keys)
    )


def wide_tables(
    rows: pd.DataFrame, layout: Layout, keys: Sequence[str]
) -> Iterator[tuple[str, pd.DataFrame, int]]:
    """Tables for papers, made of the rows of a table.

    Returns case (empty where cases are rows of one table), texts in LaTeX, and how many of the
    columns, the first ones, tell rows apart.
    """
    chosen = rows if "metric" in rows.columns else _long_form(rows, layout["metrics"], keys)
    chosen = chosen[chosen["metric"].isin(layout["metrics"])]
    for column, value in layout["where"].items():
        chosen = chosen[chosen[column] == value]
    if "forecaster" not in chosen.columns:  # a row for each case
        yield "", wide_table(chosen, ["case"], layout["columns"], specs=layout["formats"]), 1
        return
    if "seed" in chosen.columns and "seed" not in layout["more_rows"]:
        chosen = chosen[chosen["seed"].isna()]  # single networks stand in the raw table
    if layout["columns"] == "prediction_time_lt":
        whole = chosen["prediction_time_lt"] % 1 == 0
        chosen = chosen[whole] if whole.any() else chosen
    interval = PERCENTILES if "p50" in chosen.columns else INTERVAL
    for case, of_case in chosen.groupby("case", sort=False):
        row_keys = ["forecaster", *layout["more_rows"]]  # seeds only where the case has networks
        words = [_in_words(row) for row in of_case.to_dict("records")]
        named = of_case.assign(forecaster=words)
        if "strategy" in row_keys:
            named["strategy"] = _plans(named, layout["conditions"])
        for key in row_keys:
            named[key] = named[key].map(lambda value: "" if pd.isna(value) else _shown(value))
        if "seed" in row_keys and (named["seed"] == "").all():
            row_keys = [key for key in row_keys if key != "seed"]
        cells = wide_table(
            named, row_keys, layout["columns"], interval=interval, specs=layout["formats"]
        )
        cells[row_keys] = cells[row_keys].map(escape)
        cells = cells.rename(columns={name: _shown(name) for name in cells.columns})
        yield str(case), cells, len(row_keys)


def wide_table(
    table: pd.DataFrame,
    rows: Sequence[str],
    columns: str,
    *,
    interval: tuple[str, str, str] = INTERVAL,
    specs: Mapping[str, str],
) -> pd.DataFrame:
    """One row for each of several keys, one column for each value of another one.

    Rows and columns are in their order of appearance; a cell is LaTeX, a dash where nothing is.
    ``interval``: Columns of the value and the ends of its interval. ``specs``: Formats by metric;
    three significant digits without one.
    """
    if table.duplicated([*rows, columns]).any():
        raise ValueError(f"two rows have the same {', '.join([*rows, columns])}")
    cells_of_rows: dict[tuple[object, ...], dict[str, object]] = {}
    for record in table.to_dict("records"):
        key = tuple(record[name] for name in rows)
        row = cells_of_rows.setdefault(key, dict(zip(rows, key, strict=True)))
        value, low, high = (float(record[name]) for name in interval)
        row[record[columns]] = cell(value, low, high, specs.get(str(record["metric"])))
    names = list(dict.fromkeys(table[columns]))
    result = pd.DataFrame(list(cells_of_rows.values()), columns=[*rows, *names])
    return result.fillna(dict.fromkeys(names, "--"))


def cell(value: float, low: float, high: float, spec: str | None) -> str:
    """A value with its interval in LaTeX: "0.818 (0.815 to 0.824)".

    A value without an interval, or with one of no width, stands alone; no value is a dash.
    """
    if not np.isfinite(value):
        return "--"
    texts = [
        latex_number(end, digits=3) if spec is None else f"${end:{spec}}$"
        for end in (value, low, high)
        if np.isfinite(end)
    ]
    return texts[0] if len(texts) < 3 or low == high else "{} ({} to {})".format(*texts)


def _long_form(rows: pd.DataFrame, metrics: Sequence[str], keys: Sequence[str]) -> pd.DataFrame:
    """A row for each metric, with the interval that columns of its name with an ending hold."""
    keys = [key for key in keys if key in rows.columns]
    return pd.concat(
        [
            rows[keys].assign(
                metric=metric,
                value=rows[metric],
                low=rows.get(f"{metric}_low", float("nan")),
                high=rows.get(f"{metric}_high", float("nan")),
            )
            for metric in metrics
            if metric in rows.columns  # a table has no column without values
        ],
        ignore_index=True,
    )


def _in_words(row: Mapping[Any, Any]) -> str:
    """Forecaster in words: "network, 700 neurons, RV"."""
    neurons, validation = row.get("neurons"), row.get("validation")
    parts = [forecaster_label(str(row["forecaster"]))]
    parts += [] if pd.isna(neurons) else [f"{neurons} neurons"]
    return ", ".join([*parts, *([] if pd.isna(validation) else [str(validation)])])


def _shown(value: Any) -> str:
    return f"{value:g}" if isinstance(value, int | float) else str(value)


def _plans(rows: pd.DataFrame, conditions: Sequence[str]) -> list[str]:
    """Strategies of control with their settings, and with the conditions that differ."""
    names = list(rows.columns)
    settings = [
        name
        for name in names[names.index("strategy") + 1 : names.index("metric")]
        if name not in conditions or rows[name].nunique(dropna=False) > 1
    ]
    return [
        f"{row['strategy'].replace('_', ' ')} "
        f"({', '.join(_shown(row[name]) for name in settings if not pd.isna(row[name]))})"
        for row in rows.to_dict("records")
    ]
