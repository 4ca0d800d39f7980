"""Start of the workflow before any rule: checks, the config, trust in results."""

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
from burstcast_workflow.project import packages_of, project_root
from burstcast_workflow.tracking.code import Sources, make_importable, search_directories
from burstcast_workflow.tracking.results import damaged
from burstcast_workflow.tracking.run import is_known, plan

# Snakemake has not read its own options when it reads rules
_FORCING = {"--forceall", "-F", "--touch", "-t", "--unlock"}

OFF_WITHOUT_NETWORKS = "hyperparameters, examples of forecasts, control by networks, their figures"


latest: Any = None
"""Snakemake's workflow that `start` was last called with: commands inspect its plan."""


class Started(NamedTuple):
    """What rules are made of."""

    config: dict[str, Any]
    results: str  # where they lie: below a prefix where another workflow has this one as a module
    sources: Sources
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
    claim = {} if workflow.is_main_process else plan()
    directories = claim.get("directories") or search_directories(
        workflow.configfiles, project_root()
    )
    make_importable(directories)
    try:
        checked = claim.get("config") or load(config, workflow.configfiles, defaults=defaults)
    except ConfigError as error:
        raise WorkflowError(str(error)) from None
    place = workflow.modifier.path_modifier.replace_prefix(checked["results"])
    if workflow.is_main_process:
        check_results(place, forced=not _FORCING.isdisjoint(sys.argv))
    packages, beside = packages_of(project_root()), defaults.parent / "src"
    if beside.is_dir() and beside.resolve() != packages.resolve():
        raise WorkflowError(
            f"this workflow lies beside the sources in {beside}, but Python imports burstcast from "
            f"{packages}, another copy: install the one that you want to run (pip install -e)"
        )
    modules, with_libraries = own_modules(checked), checked["rerun_libraries"]
    sources = Sources(lambda name: file(f"../scripts/{name}"), packages, modules, with_libraries)
    return Started(checked, place, sources, directories, file)


def check_results(results: str, forced: bool = False) -> None:
    """Refuse a run where present results would be believed that should not be."""
    if not (forced or is_known(results)):
        raise WorkflowError(
            f"{results} was last made from another directory, or .snakemake was deleted since: "
            f"Snakemake does not know what it was made with. Run once with --forceall: what is in "
            f"the cache is not computed again"
        )
    if files := damaged(results):
        raise WorkflowError(
            f"{', '.join(files)}: not what a job wrote, but edited, exchanged or cut off since. "
            f"Delete what should be made again, and run again"
        )


def check_records(workflow: Any, campaign: Campaign) -> None:
    """Refuse files that jobs would import and that have mistakes, before any job."""
    imported, problems = campaign.where(has_equations=False, takes_series=False), []
    for job in workflow.dag.needrun_jobs():
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


def names_of_rules(workflow: Any) -> Mapping[str, Any]:
    """Names that the rules of burstcast know, also where another workflow has them as a module."""
    for rule in workflow.rules if workflow else ():
        names: Mapping[str, Any] = rule.module_globals
        if "campaign" in names and "of_script" in names:
            return names
    print("this workflow has no rules of burstcast", file=sys.stderr)
    raise SystemExit(2)
