"""Finished results of the tiny preset, and what an edit of them makes run again."""

import re
from collections.abc import Iterator
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
from edits import ConfigEdit, module_of
from helpers_rebuilds import Project, jobs_since

TABLE_SCRIPTS = {job.partition("/")[0] for job in ALL}
_TOLD_APART = {job.partition("/")[0] for job in ALL if "/" in job}


class Laboratory:
    """Edits of a working copy with finished tables, which itself stays as it is."""

    def __init__(self, directory: Path, base: Project) -> None:
        self.directory, self.base = directory, base

    @cached_property
    def loaded(self) -> dict[str, set[str]]:
        """Modules that each script loads, and each module that is found by its name."""
        return self.base.loaded_modules()

    @cached_property
    def _to_plan_in(self) -> Project:
        return self.base.copy(self.directory / "plans")

    def run_of_setting(self, edit: ConfigEdit) -> list[str]:
        """Change a setting and run: what is wrong with the jobs, or unlike a run from scratch."""
        return self._problems({*edit.expected}, edit.overlay(), {})

    def run_of_code(self, path: str, old: str, new: str) -> list[str]:
        """Change a module or a script and run."""
        return self._problems(self.jobs_with(module_of(path)), {}, {path: (old, new)})

    def _problems(
        self, expected: set[str], overlay: dict[str, Any], edits: dict[str, tuple[str, str]]
    ) -> list[str]:
        work = self.base.copy(self.directory / "work")
        for path, (old, new) in edits.items():
            work.edit(path, old, new)
        scratch = work.without_results(self.directory / "scratch")
        outcome = scratch.snakemake("tables", overlay=overlay)
        assert outcome.status == 0, outcome.text[-3000:]
        would, before = work.dry_run(overlay=overlay), work.logs()
        outcome = work.snakemake("tables", overlay=overlay)
        assert outcome.status == 0, outcome.text[-3000:]
        ran = jobs_since(before, work.logs())
        planned = sum(count for rule, count in would.items() if rule in TABLE_SCRIPTS)
        tables = work.tables()
        unlike = [name for name, digest in scratch.tables().items() if tables[name] != digest]
        return [
            *_otherwise_than(expected, {_job(name) for name in ran}),
            *(f"{name} is not that of a run from scratch" for name in unlike),
            *(f"{job} is left to do" for job in work.dry_run("tables", overlay=overlay)),
            *([f"{planned} jobs were announced, {len(ran)} ran"] if planned != len(ran) else []),
        ]

    def plan_of_setting(self, edit: ConfigEdit) -> list[str]:
        """Change a setting, and only plan: what is wrong with the plan's rules."""
        planned = self._to_plan_in.dry_run("tables", overlay=edit.overlay())
        return [*_otherwise_than({job.partition("/")[0] for job in edit.expected}, {*planned})]

    def plan_of_code(self, path: str) -> list[str]:
        """Add a constant to a module or a script, and only plan: what is wrong with the plan."""
        work = self._to_plan_in
        with work.restored(path):
            (work.directory / path).write_text((work.directory / path).read_text() + "\n_NEW = 1\n")
            planned = {_job(name) for name in work.planned()}
        of_tables = {job for job in planned if job.partition("/")[0] in TABLE_SCRIPTS}
        return [*_otherwise_than(self.jobs_with(module_of(path)), of_tables)]

    def jobs_with(self, module: str) -> set[str]:
        """Jobs that must run again when a module or script has changed."""
        if module == VERSION_OF_HARNESS:
            return set(ALL)
        if f"{module}.".startswith(HARNESS):
            return set()
        scripts = (name for name in self.loaded if name.endswith(".py"))
        return and_what_follows(
            {
                job
                for script in scripts
                for job in _jobs_of(script)
                if module == script or module in self._loaded_by(script, job)
            }
        )

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


def _otherwise_than(expected: set[str], rerun: set[str]) -> Iterator[str]:
    """What is wrong with the jobs that run again, in words."""
    if missing := expected - rerun:
        yield f"did not run again: {', '.join(sorted(missing))}"
    if needless := rerun - expected:
        yield f"ran again for nothing: {', '.join(sorted(needless))}"


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
