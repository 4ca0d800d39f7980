"""Plans of a workflow by Snakemake, for commands that inspect it without running it."""

import io
import sys
from collections.abc import Sequence
from contextlib import redirect_stderr, redirect_stdout
from typing import Any

from snakemake.cli import args_to_api, parse_args

started: Any = None
"""Snakemake's workflow that `snaketrust.start.start` was last called with."""

# options of snakemake that do something else than planning, even in a dry run
_CHANGING = (
    *("unlock", "touch", "cleanup_metadata", "cleanup_shadow", "archive", "report"),
    *("delete_all_output", "delete_temp_output", "conda_cleanup_envs"),
    *("conda_create_envs_only", "export_cwl", "containerize"),
)


def planned(arguments: Sequence[str]) -> Any:
    """Snakemake's workflow, planned under its own options; `SystemExit` if that fails."""
    global started
    started, said = None, io.StringIO()
    with redirect_stdout(said), redirect_stderr(said):
        # quiet in this way, Snakemake ends a dry run before it pretends to execute the jobs
        parser, options = parse_args([*arguments, "--dry-run", "--quiet", "rules", "progress"])
        changing = [name for name in _CHANGING if getattr(options, name, None)]
        succeeded = not changing and args_to_api(options, parser)
    if changing:
        option = f"--{changing[0].replace('_', '-')}"
        print(f"this only looks, and changes nothing: leave out {option}", file=sys.stderr)
        raise SystemExit(2)
    if not succeeded:
        print(said.getvalue(), file=sys.stderr)
        raise SystemExit(1)
    return started
