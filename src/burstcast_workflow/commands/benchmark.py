"""The benchmark: ``burstcast benchmark export``, ``score`` and ``leaderboard``."""

import sys
from collections.abc import Callable, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from burstcast.benchmark.cases import CASES, SEED, case_named
from burstcast.benchmark.data import make_case
from burstcast.benchmark.export import export
from burstcast.benchmark.forecast_files import case_of, read_forecasts
from burstcast.benchmark.leaderboard import (
    as_markdown,
    compared_with,
    page,
    read_leaderboard,
    row_of,
    with_row,
    write_leaderboard,
)
from burstcast.benchmark.records import MissingRecordError
from burstcast.benchmark.scores import score_forecasts, scores_text, write_scores
from burstcast_workflow.project import source_revision


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
    write_scores(target, scores)
    print(scores_text(scores))
    print(f"\n{case.name}, version {case.version}, seed {seed}; * is this forecaster:\n")
    print(as_markdown(compared_with(read_leaderboard(), row), row))
    print(f"\n{target}: all scores with their intervals")
    if leaderboard is not None:
        known = read_leaderboard(leaderboard) if leaderboard.exists() else []
        write_leaderboard(leaderboard, with_row(known, row))
        print(f"{leaderboard}: has the row {row['forecaster']} of {case.name}")


def show_leaderboard() -> None:
    """Print the leaderboard as a page."""
    print(page(read_leaderboard()))


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
