"""A workflow as Snakemake has planned it: to be looked at, not run."""

import io
import sys
from collections.abc import Mapping, Sequence
from contextlib import redirect_stderr, redirect_stdout
from typing import Any

from snakemake.api import DAGApi
from snakemake.cli import args_to_api, parse_args

# options of snakemake that do something else than planning, even in a dry run
_CHANGING = (
    *("unlock", "touch", "cleanup_metadata", "cleanup_shadow", "archive", "report"),
    *("delete_all_output", "delete_temp_output", "conda_cleanup_envs"),
    *("conda_create_envs_only", "export_cwl", "containerize"),
)


class _ChangingOptionError(Exception):
    """An option that would change something."""


def planned(arguments: Sequence[str]) -> Any:
    """Let Snakemake plan, and return its workflow.

    Parameters
    ----------
    arguments
        Options of snakemake.

    Raises
    ------
    SystemExit
        If Snakemake fails, and has said why; with status 2 if an option would change anything.
    """
    workflows: list[Any] = []
    execute = DAGApi.execute_workflow

    def execute_and_keep(self: DAGApi, *args: Any, **options: Any) -> Any:
        result = execute(self, *args, **options)
        workflows.append(self.workflow_api._workflow)
        return result

    said = io.StringIO()
    DAGApi.execute_workflow = execute_and_keep
    try:
        with redirect_stdout(said), redirect_stderr(said):
            # quiet in this way, Snakemake ends a dry run before it pretends to execute the jobs
            parser, options = parse_args([*arguments, "--dry-run", "--quiet", "rules", "progress"])
            if changing := [name for name in _CHANGING if getattr(options, name, None)]:
                raise _ChangingOptionError(f"--{changing[0].replace('_', '-')}")
            succeeded = args_to_api(options, parser)
    except _ChangingOptionError as option:
        print(f"this only looks, and changes nothing: leave out {option}", file=sys.stderr)
        raise SystemExit(2) from None
    finally:
        DAGApi.execute_workflow = execute
    if not succeeded or not workflows:
        print(said.getvalue(), file=sys.stderr)
        raise SystemExit(1)
    return workflows[0]


def names_of_rules(workflow: Any) -> Mapping[str, Any]:
    """Names that the rules of burstcast know, also where another workflow has them as a module.

    Raises
    ------
    SystemExit
        With status 2 if the workflow has no such rules.
    """
    for rule in workflow.rules:
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
