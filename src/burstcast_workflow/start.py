"""Start of the workflow: checks, the config, trust in results, the beginning of a run."""

import atexit
import gc
import os
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from snakemake.exceptions import WorkflowError

from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.campaign.caveats import extrapolations, few_points
from burstcast_workflow.campaign.job_settings import settings_of_job
from burstcast_workflow.campaign.loading import ConfigError, load
from burstcast_workflow.config.cases import own_modules
from burstcast_workflow.config.measured_cases import OFF
from burstcast_workflow.project import packages_of, project_root, source_revision
from burstcast_workflow.snakemake_internals import (
    at_start,
    for_each_job,
    force,
    is_in_storage,
    names_of_rules,
    outputs_of,
    parameters_of,
    path_of_results,
    planned_jobs,
    recorded,
    without_rate_limit,
)
from burstcast_workflow.stages.resources import beyond_memory
from burstcast_workflow.tracking.cache import seconds_of_rules, tidy
from burstcast_workflow.tracking.code import Sources, make_importable, search_directories
from burstcast_workflow.tracking.results import Notes
from burstcast_workflow.tracking.run import begin, plan
from snakemake_logger_plugin_burstcast.reasons import unrecorded
from snakemake_logger_plugin_burstcast.terminal import expect

OFF_WITHOUT_NETWORKS = "hyperparameters, examples of forecasts, control by networks, their figures"


latest: Any = None
"""Snakemake's workflow that `start` was last called with: commands inspect its plan."""


class Started(NamedTuple):
    """What rules are made of."""

    config: dict[str, Any]
    results: str  # where they lie: below a prefix where another workflow has this one as a module
    sources: Sources
    notes: Notes  # of the results
    directories: list[str]  # of a user's own modules
    file: Callable[[str], Path]  # of the workflow, by its path from the rules

    def beside(self, path: str) -> str:
        """A file of the workflow as an input: a relative path, so that another clone plans it."""
        return os.path.relpath(self.file(path))


def _files(workflow: Any) -> Callable[[str], Path]:
    """Files by their paths from the rules; copies of them where the workflow is a remote module."""
    rules = Path(str(workflow.current_basedir))
    if rules.is_dir():
        return lambda path: (rules / path).resolve()
    return lambda path: Path(workflow.source_path(path))


def start(workflow: Any, config: Mapping[str, Any]) -> Started:
    """Read the config and the code, for rules in the directory of the calling file of rules."""
    global latest
    latest = workflow
    file = _files(workflow)
    defaults = file("../../config.yaml")
    # Planning makes millions of objects and keeps them: looking through them for garbage all the
    # time takes a tenth of it; doing so once more when the process ends is as useless.
    gc.set_threshold(200_000, 50, 1000)
    atexit.register(gc.freeze)
    claim = {} if workflow.is_main_process else plan(_path_of_results(workflow, config))
    directories = claim.get("directories") or search_directories(
        workflow.configfiles, project_root()
    )
    make_importable(directories)
    try:
        checked = claim.get("config") or load(config, workflow.configfiles, defaults=defaults)
    except ConfigError as error:
        raise WorkflowError(str(error)) from None
    place = path_of_results(workflow, checked["results"])
    notes = checked_notes(place) if workflow.is_main_process else Notes("", {})
    packages, beside = packages_of(project_root()), defaults.parent / "src"
    if beside.is_dir() and beside.resolve() != packages.resolve():
        raise WorkflowError(
            f"this workflow lies beside the sources in {beside}, but Python imports burstcast from "
            f"{packages}, another copy: install the one that you want to run (pip install -e)"
        )
    modules, with_libraries = own_modules(checked), checked["rerun_libraries"]
    sources = Sources(lambda name: file(f"../scripts/{name}"), packages, modules, with_libraries)
    return Started(checked, place, sources, notes, directories, file)


def checked_notes(results: str) -> Notes:
    """Notes of all results; refuses a run where some are not what their jobs wrote."""
    notes = Notes.of(results)
    if faults := notes.damaged():
        text = "; ".join(faults)
        raise WorkflowError(f"{text}. Delete what should be made again, and run again")
    return notes


def _path_of_results(workflow: Any, config: Mapping[str, Any]) -> str:
    return path_of_results(workflow, str(config.get("results", "")))


def follow(workflow: Any, notes: Notes, begin_run: Callable[[], None]) -> None:
    """Let Snakemake check results while it plans jobs, and begin the run before these start."""
    checked: set[tuple[str, ...]] = set()

    def check(rule: Any, wildcards: Any) -> None:
        if not checked:
            at_start(workflow, begin_run)
        if (job := (rule.name, *wildcards)) not in checked and not is_in_storage(workflow):
            _check_results(workflow, notes, rule, wildcards)
        checked.add(job)

    if workflow.is_main_process:
        for_each_job(workflow, check)


def _check_results(workflow: Any, notes: Notes, rule: Any, wildcards: Any) -> None:
    """Let a job run if Snakemake believes in results of it that it should not believe in.

    It has no record of results that were made elsewhere, or whose record was lost, and none of
    inputs that have been exchanged for older ones.
    """
    for file in outputs_of(rule, wildcards):
        if os.path.exists(path := str(file)) and not notes.is_up_to_date(
            path, recorded(workflow, file), lambda: parameters_of(rule, wildcards)
        ):
            force(workflow, [path])
            unrecorded.add(path)


def begin_run(workflow: Any, started: Started, campaign: Campaign) -> None:
    """Begin the run that has been planned."""
    if workflow.local_exec:
        if reason := beyond_memory(member.name.neurons for member in campaign.networks):
            raise WorkflowError(reason)
        without_rate_limit(workflow)
    check_records(workflow, campaign)
    started.sources.drop_stale_bytecode()
    started.notes.stamp()
    begin(
        started.results,
        started.config,
        started.sources.whole(),
        started.directories,
        source_revision(),
    )
    tidy(10**9 * started.config["cache_gb"])
    expect(planned_jobs(workflow), seconds_of_rules())


def check_records(workflow: Any, campaign: Campaign) -> None:
    """Refuse files that jobs would import and that have mistakes, before any job."""
    imported, problems = campaign.where(has_equations=False, takes_series=False), []
    for job in planned_jobs(workflow):
        case = dict(job.wildcards.items()).get("case", "")
        data = campaign.cases[case].data if case in imported else None
        if data is None or not data.files:
            continue
        if not any(path.endswith("/ensemble.nc") for path in job.output):
            continue
        from burstcast_workflow.jobs.measured import MeasuredData  # others save the time

        wildcards = {"case": case}
        settings = settings_of_job(campaign, MeasuredData.paths(), wildcards)
        try:
            MeasuredData(settings, wildcards).measured_series([*job.input])
        except ValueError as error:
            problems.append(f"case {case}: {error}")
    if problems:
        raise WorkflowError(str(ConfigError(problems)))


def tell_what_is_off(campaign: Campaign) -> None:
    """Print what the campaign lacks, has little of, and extrapolates."""
    if not campaign.networks:
        print(f"no networks in the campaign; off: {OFF_WITHOUT_NETWORKS}", file=sys.stderr)
    measured = campaign.where(has_equations=False, is_encoded=False)
    if measured:
        print(f"{', '.join(measured)}: measured series; off: {OFF}", file=sys.stderr)
    for text in filter(None, [few_points(campaign), *extrapolations(campaign)]):
        print(text, file=sys.stderr)


def tell_what_is_hidden(sources: Sources) -> None:
    """Print what reaches code that no reading of a user's own modules finds."""
    for module, calls in sources.hidden().items():
        print(
            f"{module}: what this reaches is not followed, and its edits run nothing again: "
            f"{'; '.join(calls)}. Name its files in `files` of the case",
            file=sys.stderr,
        )


def rules_of_burstcast(workflow: Any) -> Mapping[str, Any]:
    """Names that the rules of burstcast know; ends the command where there are none."""
    names: Mapping[str, Any] | None = names_of_rules(workflow)
    if names:
        return names
    print("this workflow has no rules of burstcast", file=sys.stderr)
    raise SystemExit(2)
