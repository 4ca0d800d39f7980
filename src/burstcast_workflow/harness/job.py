"""What scripts import: the decorator of their function, settings, files.

A script is one function with explicit arguments, at its end::

    @job
    def scan(*, ensemble: str, scan: str, settings: Scan) -> None: ...

The arguments are the rule's inputs and outputs by their names, and ``settings``, whose class
declares them (`burstcast_workflow.harness.settings`). Inputs of which that class has fields, such
as the unit of time, are no arguments.
"""

from collections.abc import Callable
from functools import cache
from pathlib import Path

from burstcast.base.discovery import imported_file
from burstcast_workflow.harness.call import Call
from burstcast_workflow.harness.running import run_job, tell
from burstcast_workflow.harness.settings import JobSettings, at, computed, concerning
from burstcast_workflow.harness.storage import (
    atomic,
    read_json,
    write_json,
    write_netcdf,
    write_table,
    write_text,
)

__all__ = [
    "JobSettings",
    "at",
    "atomic",
    "computed",
    "concerning",
    "job",
    "read_json",
    "tell",
    "write_json",
    "write_netcdf",
    "write_table",
    "write_text",
]
"""The names that scripts import."""

_functions: dict[str, Callable[..., None]] = {}  # of scripts, by their modules


def job(function: Callable[..., None]) -> Callable[..., None]:
    """Run a script's function as a job if Snakemake runs the script; if not, only return it."""
    _functions[function.__module__] = function
    if snakemake := function.__globals__.get("snakemake"):
        run_job(snakemake, function, Call)
    return function


@cache
def function_of(script: Path) -> Callable[..., None]:
    """Function of a script, which is imported and runs nothing."""
    return _functions[imported_file(script).__name__]
