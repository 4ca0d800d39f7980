"""Kept tables: which these are, how they are collected, whether another run reproduces them.

::

    make results ARGS="collect RESULTS"         # a campaign's tables into docs/results
    make results ARGS="same paper RESULTS"      # whether another run's rows are in it
"""

import argparse
import json
import math
import os
import re
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import pandas as pd
from kept_tables import KEPT

from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.commands.archive import versions
from burstcast_workflow.opened import open_campaign
from burstcast_workflow.tables.registry import table_names
from burstcast_workflow.tracking.results import DamagedResultError, checked
from burstcast_workflow.tracking.run import CLAIM

OF_SINGLE_NETWORKS = (
    *("dataset", "hyperparameters", "classification", "classification_intervals"),
    *("horizon", "horizon_intervals", "statistics", "statistics_intervals", "survival"),
    *("kaplan_yorke", "lyapunov_spectrum", "control", "control_strategies"),
)
"""Kept tables with rows of their own for each network, whatever other networks there are."""

KEPT_TABLES = (
    *OF_SINGLE_NETWORKS,
    *("warnings", "control_choices", "return_times", "control_density"),
    *("training_realisations", "ranking"),
    *(
        f"{name}_percentiles"
        for name in (
            *("hyperparameters", "classification", "horizon", "statistics", "survival"),
            *("kaplan_yorke", "lyapunov_spectrum", "control"),
        )
    ),
)

# Probabilities of single networks fill large tables: only committees are kept, in campaigns about
# probabilities.
WITH_PROBABILITIES = (
    *("beyond_the_paper", "learnt_precursor", "readout_committee"),
    *("glucose", "fulda"),
    *("smoothing", "hidden_modes"),
)

VERSIONS = "versions.json"
RULE_COSTS = "rule_costs.csv"
"""Table of what the jobs of each rule took: minutes of all, largest memory.

Minutes are of the clock, on a machine that others may use, and of the processor, which are missing
in tables that are older than this column.
"""

_COST = re.compile(r"is done: (?P<seconds>[\d.]+) s, .*peak memory (?P<mib>\d+) MiB\s*$")
_EARLIER = re.compile(r"this job, which took (?P<seconds>[\d.]+) s$", re.MULTILINE)
_PROCESSOR = re.compile(r"computed in [\d.]+ s, (?P<seconds>[\d.]+) s of processor$", re.MULTILINE)
COLLECTED = {f"{name}.csv" for name in (*KEPT_TABLES, "probability_scores")}
COLLECTED |= {RULE_COSTS, VERSIONS}


class RefusedError(ValueError):
    """A campaign's tables cannot be collected or compared."""


def collect(results: Path) -> None:
    """Copy a finished campaign's tables to docs/results, with what made them.

    The copy is made beside the tables that were kept before and replaces them when it is complete.

    ``results``: Results directory of the campaign; its last name is the campaign's.
    """
    results = Path(os.path.abspath(results))
    target = KEPT / results.name
    tables = _finished_tables(results)
    if not re.fullmatch(r"[a-z][a-z0-9_]*", results.name):
        raise RefusedError(
            f"{results.name!r} cannot be the name of a campaign in {KEPT}: name the results "
            f"directory by a letter, then letters, digits and _, all of them small"
        )
    others = {path.name for path in target.iterdir()} - COLLECTED if target.is_dir() else set()
    if others or target.is_symlink() or target.is_file():
        what = ", ".join(sorted(others)) or "no directory"
        raise RefusedError(f"{target} holds what was not collected ({what}): move it first")
    with TemporaryDirectory(dir=KEPT, prefix=f".{results.name}.") as building:
        new, former = Path(building) / "new", Path(building) / "former"
        new.mkdir()
        for path in tables:
            if path.stat().st_size:
                shutil.copyfile(path, new / path.name)
        rule_costs(results / "logs").to_csv(new / RULE_COSTS, index=False)
        made_by = versions(json.loads((results / CLAIM).read_bytes()))
        text = json.dumps(made_by, indent=2, sort_keys=True)
        (new / VERSIONS).write_text(f"{text}\n", encoding="utf-8")
        if target.exists():
            target.rename(former)
        try:
            new.rename(target)
        except OSError:
            if former.exists():
                former.rename(target)
            raise


def rule_costs(logs: Path) -> pd.DataFrame:
    """What the jobs of each rule took, by their logs: a row for each rule."""
    rows = []
    for path in sorted(logs.rglob("*.log")):
        text = path.read_text(encoding="utf-8")
        if done := _COST.search(text):
            # of a job that took its results from the cache: what they took when they were computed
            seconds = float((_EARLIER.search(text) or done)["seconds"])
            rule = path.relative_to(logs).parts[0].removesuffix(".log")
            processor = _PROCESSOR.search(text)  # the log of that earlier job comes first
            processor_seconds = float(processor["seconds"]) if processor else math.nan
            rows.append((rule, seconds / 60, processor_seconds / 60, float(done["mib"])))
    columns = ["rule", "minutes", "processor_minutes", "memory_mib"]
    by_rule = pd.DataFrame(rows, columns=columns).groupby("rule")
    return pd.DataFrame(
        {
            "jobs": by_rule.size(),
            "minutes": by_rule["minutes"].sum(),
            # unknown where it is of any job
            "processor_minutes": by_rule["processor_minutes"].sum(skipna=False),
            "memory_mib": by_rule["memory_mib"].max(),
        }
    ).reset_index()


def _finished_tables(results: Path) -> list[Path]:
    """Files of the tables to collect, each of which is as its job wrote it."""
    try:
        made = table_names(Campaign(open_campaign(results).config))
    except ValueError as error:
        raise RefusedError(str(error)) from error
    more = ["probability_scores"] if results.name in WITH_PROBABILITIES else []
    paths = []
    for name in (*KEPT_TABLES, *more):
        if name not in made:
            continue
        path = results / "tables" / f"{name}.csv"
        try:
            checked(str(path))
        except FileNotFoundError:
            problem = f"{path} is missing"
        except DamagedResultError as error:
            problem = str(error)
        else:
            paths.append(path)
            continue
        raise RefusedError(f"{results} is not finished: {problem}; run the campaign first")
    return paths


def differences(campaign: str, results: Path) -> list[str]:
    """Rows of another run's tables that are not among a campaign's kept rows.

    ``results``: Results directory of a campaign that is part of the kept one: the same cases, fewer
    networks. Tables with rows for each network are compared, as text, to the last digit, in the
    columns that are kept.
    """
    kept = KEPT / campaign
    if not any((results / "tables" / f"{name}.csv").exists() for name in OF_SINGLE_NETWORKS):
        raise RefusedError(f"{results} has no tables to compare: give a campaign's results")
    if not (kept / VERSIONS).exists():
        raise RefusedError(f"{kept} has no tables to compare with: collect them first")
    problems = []
    for name in OF_SINGLE_NETWORKS:
        theirs = results / "tables" / f"{name}.csv"
        if not theirs.exists() or not theirs.stat().st_size:
            continue
        if not (kept / f"{name}.csv").exists():
            problems.append(f"{name}: is not kept")
            continue
        ours, others = (
            pd.read_csv(path, dtype=str, keep_default_na=False)
            for path in (kept / f"{name}.csv", theirs)
        )
        if missing := [str(column) for column in ours if column not in others]:
            problems.append(f"{name}: without {', '.join(missing)}")
            continue
        rows, kept_rows = (
            [",".join(row) for row in table[list(ours)].to_numpy().tolist()]
            for table in (others, ours)
        )
        unknown = set(rows).difference(kept_rows)
        problems += [f"{name}: {row}" for row in rows if row in unknown]
        print(f"{name}: {len(rows)} rows looked up", file=sys.stderr)
    return problems


def main(arguments: Sequence[str] | None = None) -> int:
    """Collect a campaign's tables, or compare another run's with them."""
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    commands = parser.add_subparsers(dest="command", required=True)
    collecting, comparing = (commands.add_parser(name) for name in ("collect", "same"))
    comparing.add_argument("campaign")
    for command in (collecting, comparing):
        command.add_argument("results", type=Path)
    chosen = parser.parse_args(arguments)
    try:
        if not KEPT.is_dir():
            raise RefusedError(f"{KEPT} is missing: kept tables are in the repository")
        if chosen.command == "collect":
            collect(chosen.results)
            return 0
        problems = differences(chosen.campaign, chosen.results)
        print("\n".join(problems) or "the same")
        return 1 if problems else 0
    except RefusedError as error:
        print(error, file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
