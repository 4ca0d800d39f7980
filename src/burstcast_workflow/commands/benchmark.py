"""The benchmark: ``burstcast benchmark export``, ``score`` and ``leaderboard``.

A case is a frozen campaign (``workflow/benchmark``), which runs below the working directory.
"""

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

import yaml

from burstcast.benchmark.forecast_files import facts_of
from burstcast.discovery import suggestion
from burstcast.files.netcdf import read_attributes
from burstcast_workflow.commands.leaderboard import (
    TABLES,
    alike,
    as_markdown,
    page,
    read_leaderboard,
    row_of,
    scores_of,
    with_row,
    write_leaderboard,
)
from burstcast_workflow.project import project_root, snakefile, source_revision

DIRECTORY = project_root() / "workflow" / "benchmark"
LEADERBOARD = DIRECTORY / "leaderboard.csv"
TASK, PAGE = "forecast_task.nc", "forecast_task.md"
_SCORED = "scored"


def cases() -> dict[str, Any]:
    """The frozen cases by name: version, campaign, digest of the data, and what they are."""
    found: dict[str, Any] = yaml.safe_load((DIRECTORY / "cases.yaml").read_text(encoding="utf-8"))
    return found


def _campaign(name: str) -> tuple[Path, dict[str, Any]]:
    """Frozen campaign of a case: its file, and the settings in it."""
    if name not in (known := cases()):
        raise ValueError(
            f"the benchmark has no case {name!r}{suggestion(name, list(known))}; its cases are "
            f"{', '.join(known)}"
        )
    path = DIRECTORY / f"{known[name]['campaign']}.yaml"
    return path, yaml.safe_load(path.read_text(encoding="utf-8"))


def _made(
    name: str,
    files: Sequence[str],
    seed: int | None = None,
    external: Mapping[str, Any] | None = None,
) -> tuple[Path, int]:
    """Let a frozen campaign make files; its results, and the seed.

    ``files``: Below the results. ``seed``: Of other data. ``external``: Forecasts that are scored
    in place of the campaign's own.
    """
    path, config = _campaign(name)
    results, frozen = Path(config["results"]), config["random_seed"]
    overlay: dict[str, Any] = {}
    if seed not in (None, frozen):
        results = results.with_name(f"{results.name}_{seed}")
        overlay = {"results": str(results), "random_seed": seed}
    if external:
        overlay["campaign"] = [
            *({**block, "forecasters": {"persistence": {}}} for block in config["campaign"]),
            {"cases": [name], "forecasters": {"external": {_SCORED: external}}},
        ]
    with tempfile.TemporaryDirectory() as directory:
        laid_over = Path(directory) / "benchmark.yaml"
        laid_over.write_text(yaml.safe_dump(overlay), encoding="utf-8")
        command = [sys.executable, "-m", "snakemake", "--snakefile", snakefile(), "--configfile"]
        targets = [f"{results}/{file}" for file in (f"{name}/{TASK}", *files)]
        status = subprocess.run(
            [*command, str(path), str(laid_over), "--", *targets],
            env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        ).returncode
    if status:
        raise SystemExit(status)
    digest = read_attributes(results / name / TASK)["case_version"]
    if seed in (None, frozen) and digest != cases()[name]["data"]:
        raise ValueError(
            f"this machine makes other data of the case {name} (digest {digest}) than the frozen "
            f"ones ({cases()[name]['data']}): scores could not be compared with the leaderboard"
        )
    return results, frozen if seed is None else seed


def export_cases(case: Sequence[str] | None, seed: int | None) -> None:
    """Make the files of cases, and the pages that explain them."""
    for name in case or cases():
        data = _campaign(name)[1]["cases"][name].get("data", {})
        missing = [path for path in data.get("files", []) if not os.path.exists(path)]
        if missing and case is None:
            print(f"left out: {name}, since {', '.join(missing)} is not here", file=sys.stderr)
            continue
        results, _ = _made(name, [f"{name}/{PAGE}"], seed)
        print(results / name / TASK, results / name / PAGE, sep="\n")


def score(
    files: Sequence[Path],
    forecaster: Sequence[str] | None,
    name: str | None,
    about: str,
    alarm_threshold: float,
    leaderboard: Path | None,
) -> None:
    """Score forecasts in files, or by a forecaster of the frozen campaign; print and write them."""
    if forecaster:
        case, alarm = forecaster
        source, _, alarm = f"{case}/{alarm}".rpartition("/")
        source = source.rpartition("/")[2]  # another case of the campaign
        name, external, seed = name or alarm, None, None
        target = Path(f"{case}_{name}.scores.csv")
    else:
        case, _, seed = facts_of(files[0])
        source, alarm, name = case, f"external-{_SCORED}", name or files[0].stem
        external = {"files": list(map(str, files)), "alarm_threshold": alarm_threshold}
        target = files[0].with_suffix(".scores.csv")
    tables = [f"{source}/tables/{table}.csv" for table in TABLES]
    results, seed = _made(case, tables, seed, external)
    scores = scores_of(results / source / "tables", alarm)
    scores.to_csv(target, index=False)
    row = row_of(
        scores,
        case=case,
        case_version=str(cases()[case]["version"]),
        seed=str(seed),
        forecaster=name,
        about=about,
        version=version("burstcast"),
        commit=source_revision(),
    )
    order = list(cases())
    print(f"{case}, version {row['case_version']}, seed {seed}; * is this forecaster:\n")
    print(as_markdown(with_row(alike(read_leaderboard(LEADERBOARD), row), row, order), row))
    print(f"\n{target}: all scores with their intervals")
    if leaderboard is not None:
        known = read_leaderboard(leaderboard) if leaderboard.exists() else []
        write_leaderboard(leaderboard, with_row(known, row, order))
        print(f"{leaderboard}: has the row {name} of {case}")


def show_leaderboard() -> None:
    """Print the leaderboard as a page."""
    print(
        page(read_leaderboard(LEADERBOARD), {name: one["about"] for name, one in cases().items()})
    )


TASKS: Mapping[str, Callable[..., None]] = {
    "export": export_cases,
    "score": score,
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
