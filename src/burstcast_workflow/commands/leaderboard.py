"""The leaderboard of the benchmark: rows from the tables of campaigns, and its page."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from textwrap import fill

import pandas as pd

from burstcast.forecast.classification import SCORES
from burstcast.forecasters._names import parsed
from burstcast.probability.alarm_rule import CALIBRATED
from burstcast_workflow.harness.storage import atomic

TABLES = (
    *("classification", "classification_intervals", "horizon", "horizon_intervals"),
    *("lead_times", "probability_scores"),
)
"""Tables of a case that have the scores."""

_SHOWN: tuple[tuple[str, float | None, str], ...] = (
    ("f_score", 1.0, "F, 1 LT"),
    ("f_score", 3.0, "F, 3 LT"),
    ("precision", 3.0, "precision, 3 LT"),
    ("recall", 3.0, "recall, 3 LT"),
    ("brier_skill", 3.0, "Brier skill, 3 LT"),
    ("calibration_error", 3.0, "calibration error, 3 LT"),
    ("mean_lead_time_lt", None, "lead time, LT"),
    ("mean_horizon_lt", None, "PH_ee, LT"),
)
"""Scores of a row, with their prediction times and their headings."""

_HEAD = """\
# Leaderboard of the benchmark

Scores of [the benchmark](benchmark.md), with bootstrap intervals of 95 %. LT is the Lyapunov time.
A score that is not defined, or whose forecasts were not handed in, is a dash. This page is made by
`make pages` from `workflow/benchmark/leaderboard.csv`, which also has the version and the commit
that made each row."""

_KEYS = ("case", "case_version", "seed", "forecaster")
_SORTED_BY = "f_score_3lt"
_SCORES = [metric if time is None else f"{metric}_{time:g}lt" for metric, time, _ in _SHOWN]
COLUMNS = (
    *_KEYS,
    "about",
    "alarm_threshold",
    *(f"{score}{end}" for score in _SCORES for end in ("", "_low", "_high")),
    "version",
    "commit",
)
"""Columns of the file."""

Row = Mapping[str, str]
"""A row of the leaderboard: the texts of its columns, empty for an undefined score."""


def scores_of(tables: Path, alarm: str) -> pd.DataFrame:
    """Scores of a source of alarms in a case: metric, prediction_time_lt, value, low, high.

    Alarms of single trajectories are the trajectory's own, all others those of the calibrated
    probability. A committee has the horizon of the forecaster whose members vote.
    """

    def rows(table: str) -> pd.DataFrame:
        found, name = pd.read_csv(tables / f"{table}.csv"), parsed(alarm)
        name = replace(name, role=None) if table.startswith("horizon") else name
        for key, value in name.keys.items():
            found = found[found[key].isna() if value is None else found[key] == value]
        return found

    by_time = ["metric", "prediction_time_lt"]
    alarms = rows("classification").melt("prediction_time_lt", [*SCORES], "metric")
    horizons = rows("horizon").melt([], ["mean_horizon_lt", "median_horizon_lt"], "metric")
    ends = ["low", "high"]
    probabilities = rows("probability_scores")
    parts = [
        alarms.merge(rows("classification_intervals")[[*by_time, *ends]]),
        probabilities[probabilities["probability"] == CALIBRATED],
        rows("lead_times").rename(columns={"lead_time_lt": "prediction_time_lt"}),
        horizons.merge(rows("horizon_intervals")[["metric", *ends]]),
    ]
    found = pd.concat([part for part in parts if len(part)])
    return found[[*by_time, "value", *ends]].drop_duplicates(by_time, ignore_index=True)


def row_of(scores: pd.DataFrame, **said: str) -> dict[str, str]:
    """Row of the leaderboard: scores, and the other columns as they are said."""
    thresholds = scores["value"][scores["metric"] == "alarm_threshold"].unique()
    one = len(thresholds) == 1  # others were chosen at each prediction time
    row = {"alarm_threshold": f"{thresholds[0]:g}" if one else ""}
    for column, (metric, time, _) in zip(_SCORES, _SHOWN, strict=True):
        times = scores["prediction_time_lt"]
        at = times.isna() if time is None else times == time
        there = scores[at & (scores["metric"] == metric)]
        for end, name in (("", "value"), ("_low", "low"), ("_high", "high")):
            row[column + end] = "".join(f"{one:.6g}" for one in there[name].dropna())
    return {column: {**said, **row}[column] for column in COLUMNS}


def read_leaderboard(path: Path) -> list[Row]:
    """Rows of a leaderboard."""
    found = pd.read_csv(path, dtype=str, keep_default_na=False)
    if tuple(found) != COLUMNS:
        raise ValueError(f"{path} is no leaderboard: its columns must be {', '.join(COLUMNS)}")
    return [dict(zip(COLUMNS, row, strict=True)) for row in found.to_numpy().tolist()]


def write_leaderboard(path: Path, rows: Iterable[Row]) -> None:
    """Write a leaderboard."""
    with atomic(path) as partial:
        pd.DataFrame(list(rows), columns=COLUMNS).to_csv(partial, index=False)


def with_row(rows: Iterable[Row], row: Row, cases: Sequence[str]) -> list[Row]:
    """Rows with one more, in the order of the cases, then of the F-score at 3 Lyapunov times.

    A row of the same forecaster, case, version and seed is replaced.
    """
    others = [other for other in rows if any(other[key] != row[key] for key in _KEYS)]

    def rank(one: Row) -> tuple[int, int, int, float, str]:
        best = -float(one[_SORTED_BY] or "-inf")
        numbers = int(one["case_version"]), int(one["seed"])
        return cases.index(one["case"]), *numbers, best, one["forecaster"]

    return sorted([*others, row], key=rank)


def alike(rows: Iterable[Row], row: Row) -> list[Row]:
    """Rows of a row's case, version and seed."""
    return [other for other in rows if all(other[key] == row[key] for key in _KEYS[:-1])]


def page(rows: Iterable[Row], abouts: Mapping[str, str]) -> str:
    """Page of the documentation with all rows, case by case."""
    parts = [_HEAD]
    for case, group in groupby(rows, key=lambda row: row["case"]):
        of_case = list(group)
        title = f"## {case}, version {of_case[0]['case_version']}, seed {of_case[0]['seed']}"
        listed = (f"* `{row['forecaster']}`: {row['about']}" for row in of_case)
        wrapped = "\n".join(fill(text, 100, subsequent_indent="  ") for text in listed)
        parts += [title, fill(abouts[case], 100), as_markdown(of_case), wrapped]
    return "\n\n".join(parts)


def as_markdown(rows: Sequence[Row], marked: Row | None = None) -> str:
    """Table of rows in Markdown; one row may be marked with an asterisk."""
    lines = [["forecaster", *(heading for _, _, heading in _SHOWN)]]
    lines += [
        [f"{row['forecaster']}{' *' if row is marked else ''}", *(_cell(row, c) for c in _SCORES)]
        for row in rows
    ]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    lines.insert(1, ["-" * width for width in widths])
    return "\n".join(
        f"| {' | '.join(cell.ljust(width) for cell, width in zip(line, widths, strict=True))} |"
        for line in lines
    )


def _cell(row: Row, column: str) -> str:
    """A score with its interval: "0.79 (0.75 to 0.82)"; zero has no sign."""
    texts = [row[f"{column}{end}"] for end in ("", "_low", "_high")]
    shown = [f"{round(float(text), 2) + 0.0:.2f}" if text else "" for text in texts]
    return f"{shown[0]} ({shown[1]} to {shown[2]})" if shown[1] else shown[0] or "-"
