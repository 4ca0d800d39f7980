"""Plans of a workflow by Snakemake, for commands that inspect it without running it."""

import io
import sys
from collections.abc import Sequence
from contextlib import redirect_stderr, redirect_stdout
from typing import Any

from snakemake.cli import args_to_api, parse_args

from burstcast_workflow import start
from burstcast_workflow.snakemake_internals import reasons_of_jobs
from snakemake_logger_plugin_burstcast.reasons import PlannedJob, explanation

# options of snakemake that do something else than planning, even in a dry run
_CHANGING = ["unlock", "touch", "cleanup_metadata", "cleanup_shadow", "archive", "report"]
_CHANGING += ["delete_all_output", "delete_temp_output", "export_cwl", "containerize"]
_CHANGING += ["conda_cleanup_envs", "conda_create_envs_only"]


def options_of(arguments: Sequence[str]) -> Any:
    """Options of Snakemake, by their names."""
    return _parsed(arguments)[1]


def _parsed(arguments: Sequence[str]) -> tuple[Any, Any]:
    """Snakemake's parser and options; `SystemExit`, with its words, for a mistake in them."""
    output = io.StringIO()
    try:
        with redirect_stdout(output), redirect_stderr(output):
            parsed: tuple[Any, Any] = parse_args([*arguments])
    except SystemExit:
        print(output.getvalue(), file=sys.stderr)
        raise
    return parsed


def planned(arguments: Sequence[str]) -> Any:
    """Snakemake's workflow, planned under its own options; `SystemExit` if that fails."""
    output = io.StringIO()
    # quiet in this way, Snakemake ends a dry run before it pretends to execute the jobs
    parser, options = _parsed([*arguments, "--dry-run", "--quiet", "rules", "progress"])
    with redirect_stdout(output), redirect_stderr(output):
        changing = [name for name in _CHANGING if getattr(options, name, None)]
        succeeded = not changing and args_to_api(options, parser)
    if changing:
        option = f"--{changing[0].replace('_', '-')}"
        print(f"this only looks, and changes nothing: leave out {option}", file=sys.stderr)
        raise SystemExit(2)
    if not succeeded:
        print(output.getvalue(), file=sys.stderr)
        raise SystemExit(1)
    return start.latest


def reasons(workflow: Any) -> str:
    """What the jobs of a plan would run for, as ``snakemake -n`` says it."""
    jobs = [
        PlannedJob(
            job.rule.name,
            job.wildcards_dict.get("case", ""),
            [*map(str, job.input)],
            [*map(str, job.output)],
            reason,
        )
        for job, reason in reasons_of_jobs(workflow)
        if job.output
    ]
    return explanation(jobs) if jobs else "Nothing would run: all results are up to date."
