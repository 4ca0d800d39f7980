"""Start of a workflow before any of its rules: `start`."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from snakemake.exceptions import WorkflowError

from snaketrust import hooks, plan
from snaketrust.fingerprint import Sources
from snaketrust.modules import compile_by_content, make_importable, search_directories
from snaketrust.planning import KnownResults
from snaketrust.project import Project
from snaketrust.run import OvertakenError, Run

MEMORY = Path(".snakemake") / "snaketrust.json"
"""What sources do, as the last plan has found out, in Snakemake's own directory (`Codes`)."""

OwnModules = Mapping[str, Sequence[str] | None]
"""Modules of a user's own that are found by name, with the files that they read (`Sources`)."""


@dataclass(frozen=True)
class Started:
    """Config and sources for rules.

    Attributes
    ----------
    config
        The whole config of the run, whatever its files say by now.
    run
        The run, with the results directory.
    sources
        The code that jobs run: `Sources.fingerprint` makes their parameter ``code``.
    """

    config: dict[str, Any]
    run: Run
    sources: Sources


def start(
    workflow: Any,
    project: Project,
    results: Callable[[dict[str, Any]], str],
    load: Callable[[], dict[str, Any]],
    own_modules: Callable[[dict[str, Any]], OwnModules] = lambda config: {},
) -> Started:
    """Make Snakemake plan by code and records, and claim the results directory before any job.

    Parameters
    ----------
    workflow
        Snakemake's.
    project
        The workflow's code.
    results
        Gives the results directory from the config.
    load
        Gives the config, plain data. It is not called for a job of a cluster, which takes the
        config from the run's claim.
    own_modules
        Gives modules of the user's own from the config.

    Raises
    ------
    UnlikeCodeError
        If Python imports other packages than those beside the workflow, or runs an old version.
    OvertakenError
        If another run has overtaken the one that this job belongs to.
    """
    plan.started = workflow
    project.check_imports()
    if not workflow.is_main_process:
        run = Run.of_job()
        claim = run.plan()
        make_importable(claim["directories"])
        config = claim["config"]
        hooks.plan_by(KnownResults(run.results))
        return Started(config, run, Sources(project, own_modules(config), MEMORY))

    directories = search_directories(workflow.configfiles, project.root)
    make_importable(directories)
    config = load()
    planned = dict(config)  # the workflow may add to the config what is no setting
    # where another workflow's prefix puts it, if it has this one as a module
    run = Run.new(workflow.modifier.path_modifier.replace_prefix(results(config)))
    sources = Sources(project, own_modules(config), MEMORY)
    compile_by_content([*project.files(), *sources.own_files()])

    def planning_is_over(workflow: Any) -> None:
        sources.codes.keep()
        _refuse_what_nothing_makes(workflow, run.results)
        if not workflow.dryrun and any(True for _ in workflow.dag.needrun_jobs()):
            try:
                run.claim(planned, sources.all_code(), directories, project.revision)
            except OvertakenError as error:
                raise WorkflowError(str(error)) from None

    hooks.install(KnownResults(run.results), planning_is_over)
    return Started(config, run, sources)


def _refuse_what_nothing_makes(workflow: Any, results: str) -> None:
    """Make it an error if a result is needed and there, but no job makes it.

    Snakemake takes such a file for a source, whether its name matches no rule or something is
    missing that it was made from, and has nothing to do.
    """
    options = workflow.dag_settings
    if options.until or options.omit_from or options.batch or options.allowed_rules:
        return
    made = {str(path) for job in workflow.dag.jobs for path in job.output}
    wanted = {str(path) for job in workflow.dag.jobs for path in job.input}
    lost = sorted(path for path in wanted - made if path.startswith(f"{results}/"))
    if lost:
        more = f", as {len(lost) - 1} others" if len(lost) > 1 else ""
        raise WorkflowError(
            f"{lost[0]} is there, but nothing makes it{more}: its name matches no rule, or a "
            f"source file is missing that it comes from (without it, Snakemake says which)"
        )
