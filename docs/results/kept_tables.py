"""The kept tables of finished campaigns, and how their numbers stand on pages.

A cell is a template over the columns of a row, such as ``{p50:.3f} ({low:.3f}–{high:.3f})``. Of
several, separated by ``||``, the first is taken whose numbers are all known.
"""

import string
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from burstcast.base.arrays import BoolArray
from burstcast.base.files.tables import read_table
from burstcast.control.setting_names import option_words
from burstcast.figures.parts.medians import with_intervals
from burstcast.figures.parts.published import intervals_of_control, published_percentiles

KEPT = Path(__file__).parent
PUBLISHED = KEPT.parents[1] / "resources" / "published_percentiles.csv"
"""Published values of the paper."""

RESULTS = ("metric", "value", "low", "high")
ROW = ("case", "forecaster", "neurons", "validation", "seed", "prediction_time_lt", "metric")
"""Columns that tell rows about networks apart."""


class Tables:
    """The tables of one campaign, by name; empty where there is none.

    ``more``: Of campaigns with further networks of the same cases; a network that the first one has
    counts once, with the numbers that it has there.
    """

    def __init__(self, directory: Path, *more: Path) -> None:
        self.directory, self.more = directory, more
        self._read = cache(self._from_file)
        self._having = cache(self._among)
        #: the one row of `medians` with some values, whose columns are its attributes
        self.row: Callable[..., Any] = cache(self._one_row)

    def __bool__(self) -> bool:
        """Whether there are any."""
        return any(self.directory.glob("*.csv"))

    def _from_file(self, name: str) -> pd.DataFrame:
        if name == "control_intervals":
            strategies, control = self._read("control_strategies"), self._read("control")
            if strategies.empty or control.empty:
                return pd.DataFrame()
            return intervals_of_control(strategies, control)
        paths = [directory / f"{name}.csv" for directory in (self.directory, *self.more)]
        tables = [read_table(path) for path in paths if path.exists() and path.stat().st_size]
        table = pd.concat(tables, ignore_index=True) if tables else pd.DataFrame()
        if self.more:
            table = table.drop_duplicates([key for key in ROW if key in table], ignore_index=True)
        if "forecaster" in table:
            table["name"] = [name_of(row) for row in table.to_dict("records")]
        return table

    def rows(self, name: str, **where: Any) -> pd.DataFrame:
        """Rows of a table whose columns have these values, or one of a list; None: no value."""
        table = self._read(name)
        if not where:
            return table
        if not {*where} <= {*table}:
            return table.iloc[:0]
        among = {key: of if isinstance(of, list) else [of] for key, of in where.items()}
        return table[np.all([self._having(name, key, *of) for key, of in among.items()], axis=0)]

    def _among(self, name: str, column: str, *values: Any) -> BoolArray:
        cells = self._read(name)[column]
        return (cells.isna() if values == (None,) else cells.isin(values)).to_numpy()

    def medians(self, name: str, metric: str, **where: Any) -> pd.DataFrame:
        """Quartiles over networks: ``p25``, ``p50``, ``p75``, and the interval of one network.

        ``low``, ``high``: Medians over networks of the ends of each one's 95 % bootstrap interval
        over test series, events, runs or flows: what the test data leave open, which all networks
        share; the scatter over training sets is not in it. NaN if there is no such interval.
        """
        rows = self.rows(f"{name}_percentiles", metric=metric, **where).dropna(subset="p50")
        ends = self.rows(f"{name}_intervals", metric=metric, **where)
        if ends.empty or rows.empty:
            return rows.assign(low=np.nan, high=np.nan)
        return with_intervals(rows, ends)

    def _one_row(self, name: str, metric: str, **where: Any) -> Any:
        rows = self.medians(name, metric, **where)
        if len(rows) != 1:
            place = f"{self.directory.name}/{name}"
            raise LookupError(f"{place}: {len(rows)} rows of {metric} with {where}, not one")
        return rows.iloc[0]

    def f(self, case: str, time: float, forecaster: str = "esn", **network: Any) -> float:
        """F-score of a forecaster so many Lyapunov times ahead, in the median over networks."""
        where = {"case": case, "prediction_time_lt": time, "forecaster": forecaster, **network}
        return float(self.row("classification", "f_score", **where).p50)

    def runs(self, name: str, **where: Any) -> pd.DataFrame:
        """Runs of control: a row each, with a column for the value and each end of each metric.

        ``left``, ``acting``: Remaining share of the exceedance, share of the time under actuation.
        ``condition``, ``means``: Condition and strategy in words. ``rarer_than_lt``: Where no event
        was observed, the return time in Lyapunov times that is exceeded with confidence 0.95.
        """
        table = self.rows(name, **where)
        keys = [column for column in table if column not in RESULTS]
        rows = []
        for _, run in table.groupby(keys, dropna=False, sort=False):
            row = {str(key): run[key].iloc[0] for key in keys}
            for metric, value, low, high in run[[*RESULTS]].itertuples(index=False):
                short = {"relative_exceedance": "left", "control_fraction": "acting"}
                title = short.get(metric, metric)
                row |= {title: value, f"{title}_low": low, f"{title}_high": high}
            if row.get("left") == 0:
                # tables of earlier versions bound the exceedance by an assumed length of events
                row |= {"left_high": np.nan, "exceedance_controlled_high": np.nan}
                row["rarer_than_lt"] = counted_time(row) / -np.log(0.05)
            rows.append({**row, "condition": condition(row), "means": means(row)})
        return pd.DataFrame(rows)

    def sizes(self, case: str) -> list[int]:
        """Numbers of neurons of a case's networks, ascending."""
        rows = self.rows("horizon_percentiles", case=case, forecaster="esn")
        return sorted(int(size) for size in rows["neurons"].unique()) if len(rows) else []

    def cases(self) -> list[str]:
        """The campaign's cases, in its order."""
        return [str(case) for case in self.rows("dataset")["case"]]


def counted_time(run: Mapping[str, Any]) -> float:
    """Counted time of all flows of a run, in Lyapunov times; NaN if its table does not tell.

    Where the number of flows is not in the table, it follows from the bound of laminarisation with
    control, 3.0 / (flows x time at risk), less the flows that laminarise without control.
    """
    if "scored_flows" in run:
        return float(run["scored_flows"] * run["span_lt"])
    if run.get("laminarisation_hazard_controlled") != 0:
        return float("nan")
    each = run["quiet_lt"] + run["span_lt"]
    flows = -np.log(0.05) / run["laminarisation_hazard_controlled_high"] / each
    kept = np.exp(-each * run["laminarisation_hazard_uncontrolled"])
    return float(flows * kept * run["span_lt"])


@cache
def _published(table: str) -> pd.DataFrame:
    return published_percentiles(read_table(PUBLISHED), table)


def published_rows(table: str, metric: str, **where: Any) -> pd.DataFrame:
    """Percentiles that the paper published, in our definitions."""
    rows = _published(table)
    for column, value in {"metric": metric, **where}.items():
        rows = rows[rows[column] == value]
    return rows


def published_value(table: str, metric: str, **where: Any) -> float:
    """A median that the paper published, in our definitions; NaN if it has not."""
    rows = published_rows(table, metric, **where)
    return float(rows["p50"].iloc[0]) if len(rows) == 1 else float("nan")


# -- words -----------------------------------------------------------------------------------------

_NAMES = {
    "equations": "equations, from the true state",
    "equations_noisy": "equations, from the noisy state",
    "equations_filtered": "equations, filtered",
    "quadratic": "learnt equations, from the noisy state",
    "quadratic_filtered": "learnt equations, filtered",
    "quadratic_aware": "aware learnt equations, from the noisy state",
    "quadratic_aware_filtered": "aware learnt equations, filtered",
    "linear_inverse": "linear inverse model",
    "analogues": "nearest analogues, mean",
    "climatology": "climatology: the base rate",
    "observable_now": "threshold on k now",
    "training": "training set",
    "floor": "halves of the data: the floor",
    "data": "the flow",
    "none": "no forecast",
    "permanent_alarm": "always-alarm forecast",
    "esn_direct": "reservoir, logistic readout of the event",
    "precursor": "boosted trees",
    "published_precursor": "published precursor",
    "nvar": "next-generation reservoir (nvar)",
}


def name_of(row: Mapping[Any, Any]) -> str:
    """The forecaster, alarm or committee of a row as people call it."""
    forecaster = str(row["forecaster"])
    kind = forecaster.removesuffix("_committee")
    name = _NAMES.get(kind, kind.replace("_", " "))
    if network := pd.notna(row.get("neurons")):
        name = f"{row['neurons']:g} neurons, {row['validation']}"
        words = kind.removeprefix("esn_").replace("_", " ")
        name = name if kind == "esn" else f"{words} network, {name}"
    if kind == forecaster:
        return name
    return f"ensemble: {name}" if network else f"members of {name}"


def condition(run: Mapping[str, Any]) -> str:
    """Under which conditions a run of control acts, in words."""
    parts = [
        f"strength {run['strength']:g}" if run["strength"] != 1 else "",
        f"{run['delay_lt']:g} LT late" if run["delay_lt"] else "",
        f"{100 * run['noise']:g} % noise" if run["noise"] != 0.01 else "",
        "unselected states" if run["starts"] != "quiet" else "",
    ]
    return ", ".join(filter(None, parts)) or "in time"


def means(run: Mapping[str, Any]) -> str:
    """Strategy of a run of control, in words, with its options and without its numbers."""
    options = run.get("options")
    words = option_words(options) if isinstance(options, str) else ""
    return ", ".join(filter(None, [str(run["strategy"]).replace("_", " "), words]))


# -- cells -----------------------------------------------------------------------------------------


class _UnknownError(Exception):
    """A number is not known."""


class _Cell(string.Formatter):
    """Numbers as text; ``share`` is a format: per cent with two digits, or all before the point."""

    def format_field(self, value: Any, format_spec: str) -> str:
        if pd.isna(value):
            raise _UnknownError
        if format_spec == "share":
            return f"{100 * value:.0f}" if abs(100 * value) >= 10 else f"{100 * value:.2g}"
        return str(format(value, format_spec))


def text(template: str, row: Mapping[Any, Any]) -> str:
    """First alternative of a template whose numbers are all known; "" if there is none."""
    for part in template.split("||"):
        try:
            return _Cell().vformat(part, (), row)
        except _UnknownError:
            continue
    return ""


Part = list[tuple[str, str, str]]
"""Label of the row, head of the column, and text of cells."""


def part(rows: pd.DataFrame, label: str, cells: Mapping[str, str]) -> Part:
    """Cells of the rows of a frame, ``cells`` by the heads of their columns, all as templates."""
    return [
        (text(label, row), text(head, row), text(cell, row))
        for row in rows.to_dict("records")
        for head, cell in cells.items()
    ]


def table(head: str, *parts: Part) -> str:
    """A Markdown table of all parts; rows and columns come in the order of their first cells."""
    cells: dict[str, dict[str, str]] = {}
    columns = dict.fromkeys(column for _, column, _ in chain(*parts))
    for row, column, cell in chain(*parts):
        if cells.setdefault(row, {}).setdefault(column, cell) != cell:
            raise ValueError(f"two cells for {row}, {column}: {cells[row][column]} and {cell}")
    with_cells = {row: of for row, of in cells.items() if any(of.values())}
    lines = [[row, *(of.get(column, "") for column in columns)] for row, of in with_cells.items()]
    return markdown([head, *columns], lines)


def markdown(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A Markdown table; a cell with ``|`` in it is several."""
    first, *lines = ("| " + " | ".join(line) + " |" for line in (head, *rows))
    return "\n".join([first, "|" + " --- |" * (first.count("|") - 1), *lines])


def best(runs: pd.DataFrame, by: list[str]) -> pd.DataFrame:
    """Of the runs of each group, the one that leaves least; of several, the one that acts least."""
    ordered: pd.DataFrame = runs.sort_values(["left", "acting"], kind="stable")
    return ordered.drop_duplicates(by).sort_index()
