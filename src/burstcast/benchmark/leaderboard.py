"""The leaderboard: a table of forecasters and their scores, with the burstcast that scored them."""

import csv
import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from pathlib import Path
from textwrap import fill

from burstcast.benchmark.cases import CASES
from burstcast.benchmark.data import CaseData
from burstcast.benchmark.scores import Score
from burstcast.files.atomic_files import atomic

PATH = Path(__file__).with_name("leaderboard.csv")
"""The leaderboard that comes with burstcast."""

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
`make pages` from `src/burstcast/benchmark/leaderboard.csv`, which also has the version and the
commit that made each row."""

_SORTED_BY = "f_score_3lt"
_KEYS = ("case", "case_version", "seed", "forecaster")
_SCORES = tuple(metric if time is None else f"{metric}_{time:g}lt" for metric, time, _ in _SHOWN)
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


def row_of(
    data: CaseData,
    scores: Sequence[Score],
    *,
    forecaster: str,
    about: str,
    alarm_threshold: float,
    version: str,
    commit: str,
) -> dict[str, str]:
    """Row of the leaderboard.

    ``scores``: Scores of `burstcast.benchmark.scores.score_forecasts`. ``forecaster``, ``about``:
    Name of the forecaster, and what it is in one line. ``alarm_threshold``: Probability at or above
    which an alarm was raised. ``version``, ``commit``: Version and commit of the burstcast that
    scored it.
    """
    by_name = {(score.metric, score.prediction_time_lt): score for score in scores}
    row = {
        "case": data.case.name,
        "case_version": str(data.case.version),
        "seed": str(data.seed),
        "forecaster": forecaster,
        "about": about,
        "alarm_threshold": f"{alarm_threshold:g}",
    }
    for column, (metric, time, _) in zip(_SCORES, _SHOWN, strict=True):
        score = by_name.get((metric, time))
        ends = ("value", "low", "high")
        for end, name in zip(("", "_low", "_high"), ends, strict=True):
            value = math.nan if score is None else getattr(score, name)
            row[column + end] = "" if math.isnan(value) else f"{value:.6g}"
    return {**row, "version": version, "commit": commit}


def read_leaderboard(path: Path = PATH) -> list[Row]:
    """Rows of a leaderboard."""
    with open(path, encoding="utf-8", newline="") as file:
        reader = csv.DictReader(file)
        rows: list[Row] = list(reader)
    if tuple(reader.fieldnames or ()) != COLUMNS:
        raise ValueError(f"{path} is no leaderboard: its columns must be {', '.join(COLUMNS)}")
    return rows


def with_row(rows: Iterable[Row], row: Row) -> list[Row]:
    """Rows with one more, in the order of the cases, then of the F-score at 3 Lyapunov times.

    A row of the same forecaster, case, version and seed is replaced.
    """
    others = [other for other in rows if any(other[key] != row[key] for key in _KEYS)]
    return sorted([*others, row], key=_rank)


def _rank(row: Row) -> tuple[int, str, int, int, float, str]:
    name, best = row["case"], -float(row[_SORTED_BY] or "-inf")
    place = list(CASES).index(name) if name in CASES else len(CASES)
    return place, name, int(row["case_version"]), int(row["seed"]), best, row["forecaster"]


def write_leaderboard(path: Path, rows: Iterable[Row]) -> None:
    """Write a leaderboard."""
    with atomic(path) as partial, open(partial, "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def compared_with(rows: Iterable[Row], row: Row) -> list[Row]:
    """Rows of a row's case, version and seed, the row among them."""
    alike = [other for other in rows if all(other[key] == row[key] for key in _KEYS[:-1])]
    return with_row(alike, row)


def page(rows: Iterable[Row]) -> str:
    """Page of the documentation with all rows, case by case."""
    parts = [_HEAD]
    for case, group in groupby(rows, key=lambda row: row["case"]):
        of_case = list(group)
        title = f"## {case}, version {of_case[0]['case_version']}, seed {of_case[0]['seed']}"
        listed = "\n".join(_wrapped(f"* `{row['forecaster']}`: {row['about']}") for row in of_case)
        parts += [title, _wrapped(CASES[case].about), as_markdown(of_case), listed]
    return "\n\n".join(parts)


def _wrapped(text: str) -> str:
    return fill(text, 100, subsequent_indent="  " * text.startswith("* "))


def as_markdown(rows: Sequence[Row], marked: Row | None = None) -> str:
    """Table of rows in Markdown; one row may be marked with an asterisk."""
    lines = [["forecaster", *(heading for _, _, heading in _SHOWN)]]
    lines += [
        [f"{row['forecaster']}{' *' if row is marked else ''}", *(_cell(row, c) for c in _SCORES)]
        for row in rows
    ]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    padded = [
        " | ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True))
        for line in lines
    ]
    rule = " | ".join("-" * width for width in widths)
    return "\n".join(f"| {line} |" for line in [padded[0], rule, *padded[1:]])


def _cell(row: Row, column: str) -> str:
    """A score with its interval: "0.79 (0.75 to 0.82)"."""
    shown = [_two_decimals(row[f"{column}{end}"]) for end in ("", "_low", "_high")]
    return f"{shown[0]} ({shown[1]} to {shown[2]})" if shown[1] else shown[0] or "-"


def _two_decimals(text: str) -> str:
    """A number with two decimals, zero without a sign; empty if there is none."""
    return f"{round(float(text), 2) + 0.0:.2f}" if text else ""
