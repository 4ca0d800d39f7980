"""Start of a workflow before any of its rules: `start`."""

import ast
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from snaketrust import hooks, plan
from snaketrust.checks import RefusedError, check_rules
from snaketrust.fingerprint import Sources
from snaketrust.modules import compile_by_content, make_importable, search_directories
from snaketrust.planning import KnownResults
from snaketrust.project import Project
from snaketrust.run import OvertakenError, Run

MEMORY = Path(".snakemake") / "snaketrust.json"
"""Cache of the code hashes of sources (`Codes`), in Snakemake's own directory."""

OwnModules = Mapping[str, Sequence[str] | None]
"""Modules of a user's own that are found by name, with the files that they read (`Sources`)."""


@dataclass(frozen=True)
class Started:
    """Config and sources for rules."""

    config: dict[str, Any]  # of the run; its files may have changed since
    run: Run  # with the results directory
    sources: Sources  # the code of jobs: `Sources.fingerprint` makes their parameter ``code``


def start(
    workflow: Any,
    project: Project,
    results: Callable[[dict[str, Any]], str],
    load: Callable[[], dict[str, Any]],
    own_modules: Callable[[dict[str, Any]], OwnModules] = lambda config: {},
    check: Callable[[], None] = lambda: None,
) -> Started:
    """Make Snakemake plan by code and records, and claim the results directory before any job.

    Parameters
    ----------
    workflow
        Snakemake's workflow.
    project
        The workflow's code.
    results
        Function from the config to the results directory.
    load
        Function that returns the config, plain data. It is not called for a job of a cluster, which
        takes the config from the run's claim.
    own_modules
        Function from the config to the user's own modules.
    check
        Function that is called when all jobs are known, in a dry run, too: a run that it refuses,
        with a `RefusedError`, leaves the results directory as it was.

    Raises
    ------
    UnlikeCodeError
        If Python imports other packages than those beside the workflow, or runs an old version.
    RefusedError
        If the Snakefile starts a second workflow with other results or another config, or (at the
        end of planning) the results of a rule cannot be trusted.
    OvertakenError
        If another run has overtaken the one that this job belongs to.
    """
    project.check_imports()
    if not workflow.is_main_process:
        run = Run.of_job()
        claim = run.plan()
        make_importable(claim["directories"])
        config = claim["config"]
        config = ast.literal_eval(config) if isinstance(config, str) else config
        plan.started = workflow
        hooks.plan_by(KnownResults(run.results))
        return Started(config, run, Sources(project, own_modules(config), MEMORY))

    directories = search_directories(workflow.configfiles, project.root)
    make_importable(directories)
    config = load()
    planned = _told(config)  # the workflow may add to the config what is no setting
    # with the prefix of a workflow that uses this one as a module
    place = workflow.modifier.path_modifier.replace_prefix(results(config))
    if plan.started is workflow:
        return _once_more(project, place, planned)
    plan.started = workflow
    run = Run.new(place)
    sources = Sources(project, own_modules(config), MEMORY)
    compile_by_content([*project.files(), *sources.own_files()])

    def planning_is_over(workflow: Any) -> None:
        sources.codes.keep()
        compile_by_content(sources.reached())
        check_rules(workflow, known, sources.unseen)
        _refuse_what_nothing_makes(workflow, known)
        check()
        if not workflow.dryrun and any(True for _ in workflow.dag.needrun_jobs()):
            try:
                made = sorted(
                    known.records.name(str(path))
                    for job in workflow.dag.jobs
                    for path in job.output
                )
                run.claim(planned, sources.all_code(), directories, project.revision, made)
            except OvertakenError as error:
                raise RefusedError(str(error)) from None

    known = KnownResults(run.results)
    hooks.install(known, planning_is_over)
    started = Started(config, run, sources)
    _first[:] = project.root, place, repr(planned), started
    return started


_first: list[Any] = []  # root, results and config of the last workflow, and its `Started`


def _told(config: dict[str, Any]) -> Any:
    """Config as the claim holds it for jobs: as it is, or as text where JSON would change it."""
    text = repr(config)
    try:
        if ast.literal_eval(text) != config:
            raise ValueError("it changes when it is written and read")
        return dict(config) if repr(json.loads(json.dumps(config))) == text else text
    except (TypeError, ValueError, SyntaxError) as error:
        raise RefusedError(f"the config is no plain data ({error}): jobs cannot read it") from None


def _once_more(project: Project, results: str, planned: Any) -> Started:
    """Return what the same module received when `use rule` first read it."""
    if [project.root, results, repr(planned)] != _first[:3]:
        raise RefusedError(
            f"this Snakefile starts snaketrust for {_first[1]} and for {results}: one run owns one "
            f"results directory; run the two workflows one after the other, from a Snakefile each"
        )
    found: Started = _first[3]
    return found


def _refuse_what_nothing_makes(workflow: Any, known: KnownResults) -> None:
    """Refuse a workflow that needs an existing result that none of its jobs makes.

    Snakemake takes such a file for a source, and has nothing to do, although its name matches no
    rule, or a file that it was made from is missing.
    """
    options = workflow.dag_settings
    if options.until or options.omit_from or options.batch or options.allowed_rules:
        return
    made = {str(path) for job in workflow.dag.jobs for path in job.output}
    wanted = {str(path) for job in workflow.dag.jobs for path in job.input}
    if lost := sorted(path for path in wanted - made if path in known):
        more = f", as {len(lost) - 1} others" if len(lost) > 1 else ""
        raise RefusedError(
            f"{lost[0]} is there, but nothing makes it{more}: its name matches no rule, or is "
            f"spelt otherwise there, or a source file is missing that it comes from (without it, "
            f"Snakemake says which)"
        )
