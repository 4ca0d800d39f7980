"""The benchmark: ``burstcast benchmark export``, ``score`` and ``leaderboard``."""

import csv
import dataclasses
import sys
from collections.abc import Callable, Mapping, Sequence
from importlib.metadata import version
from itertools import groupby
from pathlib import Path
from textwrap import fill
from typing import Any

from burstcast.benchmark.cases import CASES, SEED, case_named
from burstcast.benchmark.data import make_case
from burstcast.benchmark.export import export
from burstcast.benchmark.forecast_files import case_of, read_forecasts
from burstcast.benchmark.leaderboard import (
    as_markdown,
    compared_with,
    read_leaderboard,
    row_of,
    with_row,
    write_leaderboard,
)
from burstcast.benchmark.records import MissingRecordError
from burstcast.benchmark.scores import Score, score_forecasts
from burstcast.files.atomic_files import atomic
from burstcast_workflow.project import source_revision

_PAGE = """\
# Leaderboard of the benchmark

Scores of [the benchmark](benchmark.md), with bootstrap intervals of 95 %. LT is the Lyapunov time.
A score that is not defined, or whose forecasts were not handed in, is a dash. This page is made by
`make pages` from `src/burstcast/benchmark/leaderboard.csv`, which also has the version and the
commit that made each row."""


_BY_TIME = ("precision", "recall", "f_score", "brier_skill", "calibration_error")
_OF_ALL = ("mean_lead_time_lt", "missed_fraction", "mean_horizon_lt", "median_horizon_lt")


def export_cases(directory: Path, case: Sequence[str] | None, seed: int | None) -> None:
    """Write files of cases, and the page that explains them."""
    root = SEED if seed is None else seed
    found = []
    for one in [case_named(name) for name in case or CASES]:
        try:
            found.append(make_case(one, root).exported)
        except MissingRecordError as error:
            if case:
                raise
            print(f"left out: {error}", file=sys.stderr)
    for path in export(directory, found):
        print(path)


def score_files(
    files: Sequence[Path],
    name: str | None,
    about: str,
    alarm_threshold: float,
    output: Path | None,
    leaderboard: Path | None,
) -> None:
    """Score the forecasts of one forecaster, print the scores and write them."""
    if not 0 <= alarm_threshold <= 1:
        raise ValueError(f"--alarm-threshold must be between 0 and 1, not {alarm_threshold:g}")
    case, seed = case_of(files)
    data = make_case(case, seed)
    scores = score_forecasts(data, read_forecasts(files, data.task), alarm_threshold)
    row = row_of(
        data,
        scores,
        forecaster=name or files[0].stem,
        about=about,
        alarm_threshold=alarm_threshold,
        version=version("burstcast"),
        commit=source_revision(),
    )
    target = output or files[0].with_suffix(".scores.csv")
    _write(target, scores)
    print(_table(scores))
    print(f"\n{case.name}, version {case.version}, seed {seed}; * is this forecaster:\n")
    print(as_markdown(compared_with(read_leaderboard(), row), row))
    print(f"\n{target}: all scores with their intervals")
    if leaderboard is not None:
        known = read_leaderboard(leaderboard) if leaderboard.exists() else []
        write_leaderboard(leaderboard, with_row(known, row))
        print(f"{leaderboard}: has the row {row['forecaster']} of {case.name}")


def show_leaderboard() -> None:
    """Print the leaderboard as a page."""
    print(_PAGE)
    for case, group in groupby(read_leaderboard(), key=lambda row: row["case"]):
        rows = list(group)
        title = f"## {case}, version {rows[0]['case_version']}, seed {rows[0]['seed']}"
        listed = "\n".join(_wrapped(f"* `{row['forecaster']}`: {row['about']}") for row in rows)
        about = _wrapped(CASES[case].about)
        print(f"\n{title}\n\n{about}\n\n{as_markdown(rows)}\n\n{listed}")


def _wrapped(text: str) -> str:
    return fill(text, 100, subsequent_indent="  " * text.startswith("* "))


def _write(path: Path, scores: Sequence[Score]) -> None:
    columns = [field.name for field in dataclasses.fields(Score)]
    with atomic(path) as partial, open(partial, "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerows([columns, *map(dataclasses.astuple, scores)])


def _table(scores: Sequence[Score]) -> str:
    """Main scores: by prediction time, then of all prediction times together."""
    times = list(dict.fromkeys(one.prediction_time_lt for one in scores if one.metric == "f_score"))
    shown = {(one.metric, one.prediction_time_lt): _cell(one) for one in scores}
    lines = [["", *(f"{time:g} LT" for time in times)]]
    lines += [[metric, *(shown[metric, time] for time in times)] for metric in _BY_TIME]
    lines += [[metric, shown[metric, None]] for metric in _OF_ALL if (metric, None) in shown]
    return "\n".join(
        f"{line[0]:20}{''.join(cell.rjust(26) for cell in line[1:])}" for line in lines
    )


def _cell(score: Score) -> str:
    return f"{score.value:.3f} ({score.low:.3f} to {score.high:.3f})"


TASKS: Mapping[str, Callable[..., None]] = {
    "export": export_cases,
    "score": score_files,
    "leaderboard": show_leaderboard,
}


def main(task: str, **arguments: Any) -> int:
    """Run one of the `TASKS`; 2, and a message, where its input makes no sense."""
    try:
        TASKS[task](**arguments)
    except (ValueError, OSError) as error:
        print(f"burstcast benchmark {task}: {error}", file=sys.stderr)
        return 2
    return 0
