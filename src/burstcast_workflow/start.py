"""Start of the workflow before any rule: checks, the config, trust in results."""

import atexit
import gc
import os
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.config.case_checks import extrapolations, few_points
from burstcast_workflow.config.cases import own_modules
from burstcast_workflow.config.loading import ConfigError, load
from burstcast_workflow.config.measured_cases import OFF
from burstcast_workflow.project import code_of
from snaketrust import start as trust
from snaketrust.checks import RefusedError
from snaketrust.modules import UnlikeCodeError
from snaketrust.run import OvertakenError

REFUSALS = (ConfigError, OvertakenError, UnlikeCodeError)
"""Errors that stop a run before it starts, shown without a traceback."""


OFF_WITHOUT_NETWORKS = "hyperparameters, examples of forecasts, control by networks, their figures"


def start(
    workflow: Any, config: Mapping[str, Any], project: Path, check: Callable[[], None]
) -> trust.Started:
    """Check the code and the config, and make Snakemake plan by records and claim the results.

    ``check``: Called when all jobs are known, before any of them (`snaketrust.start.start`).
    """
    # Planning makes millions of objects and keeps them: looking through them for garbage all the
    # time takes a tenth of it; doing so once more when the process ends is as useless.
    gc.set_threshold(200_000, 50, 1000)
    atexit.register(gc.freeze)
    os.environ["MPLBACKEND"] = "agg"  # jobs draw to files, also if a notebook has started them
    started = trust.start(
        workflow,
        code_of(project),
        results=lambda whole: str(whole["results"]),
        load=lambda: load(config, workflow.configfiles, defaults=project / "config.yaml"),
        own_modules=own_modules,
        check=check,
    )
    if undeclared := started.sources.undeclared():
        raise ConfigError(
            [
                f"{path}, {place} reads a file that the config does not declare: list it in the "
                f"setting files, beside system (files: [] if there is none)"
                for path, place in undeclared
            ]
        )
    return started


def check_records(workflow: Any, campaign: Campaign) -> None:
    """Refuse files that jobs would import and that have mistakes, before any job."""
    problems = []
    for job in workflow.dag.needrun_jobs():
        case = job.wildcards.get("case", "")
        data = campaign.cases[case].data if case in campaign.cases else None
        if data is None or not data.files:
            continue
        if not any(path.endswith("/ensemble.nc") for path in job.output):
            continue
        from burstcast_workflow.jobs.measured import MeasuredData  # others save the time

        try:
            MeasuredData(job.params["settings"], {"case": case}).measured_series(data.paths)
        except ValueError as error:
            problems.append(f"case {case}: {error}")
    if problems:
        raise RefusedError(str(ConfigError(problems)))


def tell_what_is_off(campaign: Campaign) -> None:
    """Print what the campaign lacks, has little of, and extrapolates."""
    if not campaign.networks:
        print(f"no networks in the campaign; off: {OFF_WITHOUT_NETWORKS}", file=sys.stderr)
    measured = [case for case in campaign.measured_cases if case not in campaign.encoded_cases]
    if measured:
        print(f"{', '.join(measured)}: measured series; off: {OFF}", file=sys.stderr)
    for text in filter(None, [few_points(campaign.config), *extrapolations(campaign.config)]):
        print(text, file=sys.stderr)


def names_of_rules(workflow: Any) -> Mapping[str, Any]:
    """Names that the rules of burstcast know, also where another workflow has them as a module."""
    for rule in workflow.rules if workflow else ():
        names: Mapping[str, Any] = rule.module_globals
        if "campaign" in names and "run" in names:
            return names
    print("this workflow has no rules of burstcast", file=sys.stderr)
    raise SystemExit(2)


def covers_campaign(workflow: Any) -> bool:
    """Whether a plan has all jobs of the campaign, whether they would run or not."""
    options = workflow.dag_settings
    targets = {job.rule.name for job in workflow.dag.jobs if not job.output}
    # as a module, its rules may have a prefix
    whole = any(name == "all" or name.endswith("_all") for name in targets)
    return whole and not (options.until or options.omit_from or options.batch)
