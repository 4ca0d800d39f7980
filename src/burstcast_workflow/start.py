"""What the workflow does before any rule: check itself, read the config, patch Snakemake."""

import atexit
import gc
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from snakemake.exceptions import WorkflowError

from burstcast_workflow import code_hash
from burstcast_workflow.config.cases import own_modules
from burstcast_workflow.config.loading import ConfigError, load
from burstcast_workflow.config.measured_cases import OFF
from burstcast_workflow.fingerprint import Sources
from burstcast_workflow.harness.code_check import (
    CodeChangedError,
    check_imports,
    compile_by_content,
)
from burstcast_workflow.harness.run import OvertakenError, Run
from burstcast_workflow.harness.search_path import make_importable, search_directories
from burstcast_workflow.planning import plan_by_records
from burstcast_workflow.project import packages_of
from burstcast_workflow.snakemake_patches import (
    claim_before_jobs,
    interrupt_quietly,
    plan_without_idle_groups,
    refuse_what_nothing_makes,
    start_jobs_without_delay,
)

REFUSALS = (CodeChangedError, ConfigError, OvertakenError)
"""Why a run does not start: what a person is told, without a traceback."""


class RefusedError(WorkflowError):  # type: ignore[misc]
    """A run does not start; Snakemake prints no lines of the rules below the reason."""

    __traceback__ = None


class Started(NamedTuple):
    """What rules stand on: the whole config, checked; whose results they are; jobs' code."""

    config: dict[str, Any]
    run: Run
    sources: Sources


def start(workflow: Any, config: Mapping[str, Any], project: Path) -> Started:
    """Check the code and the config, and make Snakemake plan and claim as this workflow wants it.

    Parameters
    ----------
    workflow
        Snakemake's; that of a job on a cluster takes what was planned, whatever files say by now.
    config
        What its files and the command line say.
    project
        Directory of the ``Snakefile``.

    Raises
    ------
    CodeChangedError
        If the code is not that which is imported.
    ConfigError
        If the config has a mistake.
    OvertakenError
        If another run has overtaken this one.
    """
    # Planning makes millions of objects and keeps them: looking through them for garbage all the
    # time takes a tenth of it; doing so once more when the process ends is as useless.
    gc.set_threshold(200_000, 50, 1000)
    atexit.register(gc.freeze)
    check_imports(packages_of(project))
    if workflow.is_main_process:
        directories = search_directories(workflow.configfiles, project)
        make_importable(directories)
        whole = load(config, workflow.configfiles, defaults=project / "config.yaml")
        # where another workflow's prefix puts it, if it has this one as a module
        run = Run.new(workflow.modifier.path_modifier.replace_prefix(whole["results"]))
    else:
        run = Run.of_job()
        whole, directories = run.plan()["config"], run.plan()["directories"]
        make_importable(directories)
    code_hash.recall(run.results)
    sources = Sources(project, own_modules(whole))
    plan_by_records(run.results)
    if workflow.is_main_process:
        if undeclared := sources.undeclared():
            raise ConfigError(undeclared)
        compile_by_content(packages_of(project), sources.own_files())
        start_jobs_without_delay()
        plan_without_idle_groups()
        interrupt_quietly()
        refuse_what_nothing_makes(run.results)
        claim_before_jobs(run, dict(whole), sources, directories)
    return Started(whole, run, sources)


def tell_what_is_off(cases: Sequence[str]) -> None:
    """Say to a person which cases are measured series, and what they do without."""
    if cases:
        print(f"{', '.join(cases)}: measured series; off: {OFF}", file=sys.stderr)
