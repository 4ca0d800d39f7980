"""Trials: an edit, a run that goes on from finished results, and a run from scratch."""

import hashlib
import json
import os
import re
import shutil
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from dependencies import (
    ALL,
    FORECASTERS_BY_NAME,
    FOUND_BY_NAME,
    HARNESS,
    JOBS_OF_NETWORKS,
    JOINING,
    MAKERS,
    STRATEGIES,
    STRATEGIES_BY_NAME,
    TABLES_OF_A_CASE,
    TABLES_OF_CASES,
    VERSION_OF_HARNESS,
    and_what_follows,
)
from edits import (
    CodeEdit,
    ConfigEdit,
    added_statement,
    changed_meanings,
    code_files,
    config_edits,
    merged,
    tiny_config,
)
from helpers_rebuilds import PARTS, ROOT, JobServer, Outcome, Project, jobs_since

_EDITS_TRIED = 3


@dataclass
class Trial:
    """What came of an edit."""

    name: str
    what: str
    rerun: list[str]  # what ran again for the tables, as the oracle calls it
    jobs: int
    figures: int  # jobs of the figures that would run again
    tables: int
    tables_changed: int
    seconds: float
    problems: list[str] = field(default_factory=list)


class Laboratory:
    """Finished results of the tiny preset, from which trials start.

    Parameters
    ----------
    directory
        Where everything is kept. Trials and runs from scratch that are there already are not made
        again, as long as the project's sources stay the same.
    base
        A working copy with finished tables; None: one is made, its figures included, so that
        trials count those that would be drawn again.
    """

    def __init__(self, directory: Path, server: JobServer, base: Project | None = None) -> None:
        self.directory, self.server = directory, server
        (directory / "trials").mkdir(parents=True, exist_ok=True)
        (directory / "scratch").mkdir(exist_ok=True)
        self.base = base if base is not None else self._finished()

    def _finished(self) -> Project:
        """Finished results of this directory, made anew if the sources have changed."""
        directory, fingerprint = self.directory, source_digest()
        note = directory / "sources"
        if not note.exists() or note.read_text() != fingerprint:
            for name in ("base", "work", "trials", "scratch"):
                shutil.rmtree(directory / name, ignore_errors=True)
            (directory / "trials").mkdir()
            (directory / "scratch").mkdir()
            base = Project.create(directory / "base", self.server)
            outcome = base.snakemake("tables")
            assert outcome.status == 0, outcome.text[-3000:]
            base.snakemake()  # whether they can be drawn is tested elsewhere
            note.write_text(fingerprint)
        return Project(directory / "base", self.server)

    @cached_property
    def base_tables(self) -> dict[str, str]:
        return self.base.tables()

    @cached_property
    def loaded(self) -> dict[str, set[str]]:
        """Modules that each script loads, and each module that is found by its name."""
        return self.base.loaded_modules()

    def config_trial(self, edit: ConfigEdit) -> Trial:
        """Change a setting."""
        return self._remembered(edit.name, lambda: self._config_trial(edit))

    def _config_trial(self, edit: ConfigEdit) -> Trial:
        start = time.monotonic()
        overlay = edit.overlay()
        work = self.base.copy(self.directory / "work")
        scratch = self._from_scratch(overlay)
        return self._judged(
            work, overlay, scratch, f"-> {edit.value}", edit, set(edit.expected), start
        )

    def code_trial(self, path: str) -> Trial:
        """Change a module or a script."""
        return self._remembered(path, lambda: self._code_trial(path))

    def _code_trial(self, path: str) -> Trial:
        start = time.monotonic()
        edit, scratch = self._edit_that_runs(path)
        work = self.base.copy(self.directory / "work")
        (work.directory / path).write_text(edit.text)
        expected = self.jobs_with(edit.module)
        return self._judged(work, {}, scratch, edit.what, edit, expected, start)

    def plan_of_config_trial(self, edit: ConfigEdit) -> list[str]:
        """Change a setting, and only plan: what is wrong with the plan's rules."""
        planned = self._to_plan_in.dry_run("tables", overlay=edit.overlay())
        return _otherwise_than({job.partition("/")[0] for job in edit.expected}, {*planned})

    def plan_of_code_trial(self, path: str) -> list[str]:
        """Change a module or a script, and only plan: what is wrong with the plan."""
        edit, work = added_statement(path), self._to_plan_in
        with work.restored(path):
            (work.directory / path).write_text(edit.text)
            planned = {_job(name) for name in work.planned()}
        of_tables = {job for job in planned if job.partition("/")[0] in TABLE_SCRIPTS}
        return _otherwise_than(self.jobs_with(edit.module), of_tables)

    @cached_property
    def _to_plan_in(self) -> Project:
        return self.base.copy(self.directory / "plans")

    def jobs_with(self, module: str) -> set[str]:
        """Jobs that must run again when a module or script has changed."""
        if module == VERSION_OF_HARNESS:
            return set(ALL)
        if f"{module}.".startswith(HARNESS):
            return set()
        jobs = set()
        for script in (name for name in self.loaded if name.endswith(".py")):
            for job in _jobs_of(script):
                loaded = self._loaded_by(script, job)
                if module == script or module in loaded:
                    jobs.add(job)
        return and_what_follows(jobs)

    def _loaded_by(self, script: str, job: str) -> set[str]:
        """Modules that a script loads at its start, and those that its job finds by name."""
        loaded = self.loaded[script]
        if script == TABLES_OF_A_CASE:
            loaded = loaded | self.loaded[f"{MAKERS}.{job}"]
        by_name = {
            name
            for registry, names in FOUND_BY_NAME.items()
            if registry in loaded
            for name in names
        }
        whose = "esn" if job in JOBS_OF_NETWORKS else job.partition("/")[2].partition("/")[0]
        kind, _, role = whose.partition("-")
        registry, prefix = FORECASTERS_BY_NAME
        if registry in loaded and kind != "none" and role != "random":
            by_name.add(f"{prefix}{kind}")
        registry, prefix = STRATEGIES_BY_NAME
        if registry in loaded:
            by_name.update(f"{prefix}{name}" for name in STRATEGIES.get(job, ()))
        return loaded.union(*(self.loaded[name] for name in by_name))

    def _edit_that_runs(self, path: str) -> tuple[CodeEdit, dict[str, str]]:
        """Find an edit that changes tables, if there is one among the first few."""
        added = added_statement(path)
        jobs = self.jobs_with(added.module)
        if not jobs:
            return added, self.base_tables
        found = added, self.base_tables
        for number, edit in enumerate(changed_meanings(path)):
            if number == _EDITS_TRIED:
                break
            work = self.base.without_results(self.directory / "scratch-work")
            (work.directory / path).write_text(edit.text)
            if work.snakemake("tables").status == 0:
                found = edit, work.tables()
                if found[1] != self.base_tables:
                    break
        return found

    def _from_scratch(self, overlay: dict[str, Any]) -> dict[str, str]:
        """Tables of a run from scratch; configs that differ in figures only share one."""
        config = merged(tiny_config(), overlay)
        relevant = {key: value for key, value in config.items() if key != "figures"}
        used = [f"Re{value:g}" for value in config["campaign"][0]["reynolds"]]
        defaults = relevant.pop("case_defaults")
        relevant["cases"] = {name: merged(defaults, config["cases"].get(name, {})) for name in used}
        digest = hashlib.sha256(json.dumps(relevant, sort_keys=True).encode()).hexdigest()
        memory = self.directory / "scratch" / f"{digest[:20]}.json"
        if not memory.exists():
            work = self.base.without_results(self.directory / "scratch-work")
            outcome = work.snakemake("tables", overlay=overlay)
            assert outcome.status == 0, outcome.text[-3000:]
            memory.write_text(json.dumps(work.tables()))
        return dict(json.loads(memory.read_text()))

    def _judged(
        self,
        work: Project,
        overlay: dict[str, Any],
        scratch: dict[str, str],
        what: str,
        edit: ConfigEdit | CodeEdit,
        expected: set[str],
        start: float,
    ) -> Trial:
        """Run the edited copy, and compare."""
        problems = []
        would = work.dry_run(overlay=overlay)
        before = work.logs()
        outcome: Outcome = work.snakemake("tables", overlay=overlay)
        if outcome.status != 0:
            problems.append(f"the run failed: {outcome.text[-2000:]}")
        ran = jobs_since(before, work.logs())
        rerun = {_job(name) for name in ran}
        problems += _otherwise_than(expected, rerun)
        tables = work.tables()
        different = sorted(name for name in scratch if tables.get(name) != scratch[name])
        if different:
            problems.append(f"differs from a run from scratch: {', '.join(different)}")
        if again := work.dry_run("tables", overlay=overlay):
            problems.append(f"is not finished afterwards: {again}")
        planned = sum(count for rule, count in would.items() if rule in TABLE_SCRIPTS)
        if planned != len(ran):
            problems.append(f"{planned} jobs were announced, {len(ran)} ran")
        return Trial(
            name=edit.name,
            what=what,
            rerun=sorted(rerun),
            jobs=len(ran),
            figures=sum(count for rule, count in would.items() if rule not in TABLE_SCRIPTS),
            tables=len(scratch),
            tables_changed=sum(self.base_tables.get(name) != scratch[name] for name in scratch),
            seconds=round(time.monotonic() - start, 1),
            problems=problems,
        )

    def _remembered(self, name: str, make: Any) -> Trial:
        memory = self.directory / "trials" / f"{name.replace('/', '+')}.json"
        if memory.exists():
            return Trial(**json.loads(memory.read_text()))
        trial: Trial = make()
        memory.write_text(json.dumps(asdict(trial), indent=1))
        return trial


TABLE_SCRIPTS = {job.partition("/")[0] for job in ALL}
_TOLD_APART = {job.partition("/")[0] for job in ALL if "/" in job}


def _otherwise_than(expected: set[str], rerun: set[str]) -> list[str]:
    """What is wrong with the jobs that run again, in words."""
    differences = {
        "did not run again": expected - rerun,
        "ran again for nothing": rerun - expected,
    }
    return [f"{what}: {', '.join(sorted(jobs))}" for what, jobs in differences.items() if jobs]


def _job(log: str) -> str:
    """What the oracle calls the job of a log: with the kind that forecasts."""
    rule, *parts = log.removesuffix(".log").split("/")
    if rule not in _TOLD_APART:
        return rule
    # esn-N40-RV-seed0-random is esn-random
    job = f"{rule}/{re.sub(r'-(N[0-9]+|[A-Z]+|seed[0-9]+)', '', parts[1])}"
    strategy = parts[-1].partition("-")[0]
    return f"{job}/{strategy}" if f"{job}/{strategy}" in ALL else job


def _jobs_of(script: str) -> list[str]:
    """Jobs of a script; those for figures are none of the tables'."""
    if script.startswith("figures/"):
        return []
    if script == TABLES_OF_A_CASE:
        return list(TABLES_OF_CASES)
    rule = Path(script).stem
    return [job for job in ALL if JOINING.get(job, job.partition("/")[0]) == rule]


def source_digest() -> str:
    """Digest of the project's sources, without what Python has compiled."""
    digest = hashlib.sha256()
    for part in PARTS:
        for path in sorted([ROOT / part, *(ROOT / part).rglob("*")]):
            if path.is_file() and path.suffix != ".pyc":
                digest.update(f"{path.relative_to(ROOT)}\n".encode() + path.read_bytes())
    return digest.hexdigest()


@contextmanager
def laboratory(directory: Path) -> Iterator[Laboratory]:
    """A laboratory with its server."""
    directory.mkdir(parents=True, exist_ok=True)
    server = JobServer(directory)
    Path(server.address).unlink(missing_ok=True)
    with server.running():
        yield Laboratory(directory, server)


def summary(directory: Path) -> str:
    """Results of all trials as the last section of docs/selective_rebuild_trials.md."""
    trials = [
        Trial(**json.loads(path.read_text()))
        for path in sorted((directory / "trials").glob("*.json"))
    ]
    planned = len(config_edits()) + len(code_files())
    failed = sum(bool(trial.problems) for trial in trials)
    with_effect = sum(trial.tables_changed > 0 for trial in trials)
    lines = [
        f"{len(trials)} edits of {planned} so far, {failed} failed; {with_effect} changed tables.",
        "",
        "| edit | what | jobs | rules run again | figure jobs | tables changed | verdict |",
        "|---|---|---|---|---|---|---|",
    ]
    for trial in trials:
        rules = ", ".join(sorted({name.partition("/")[0] for name in trial.rerun})) or "none"
        what = trial.what.replace("|", "\\|")
        verdict = "; ".join(trial.problems).replace("|", "\\|")[:200] or "equal bits"
        lines.append(
            f"| `{trial.name}` | {what} | {trial.jobs} | {rules} | {trial.figures} "
            f"| {trial.tables_changed} of {trial.tables} | {verdict} |"
        )
    return "\n".join(lines)


if __name__ == "__main__":
    print(summary(Path(sys.argv[1] if len(sys.argv) > 1 else os.environ["BURSTCAST_TRIALS"])))
