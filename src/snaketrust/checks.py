"""Rules whose results cannot be trusted: refused when all is planned, before any job."""

import inspect
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from snakemake.exceptions import WorkflowError

from snaketrust.plain import named, plain
from snaketrust.planning import KnownResults

_KINDS = {
    "shellcmd": "shell:",
    "run_func_src": "run:",
    "notebook": "notebook:",
    "wrapper": "wrapper:",
    "cwl": "cwl:",
    "template_engine": "template_engine:",
    "shadow_depth": "shadow:",
}
_FLAGS = {
    **dict.fromkeys(
        ("directory", "touch", "pipe", "service", "update", "storage_object"),
        "which has no record: list plain files",
    ),
    "ensure": "which is not checked where a run is killed: check it in the script",
}


class RefusedError(WorkflowError):  # type: ignore[misc]
    """A run does not start; Snakemake prints no lines of files below the reason."""

    __traceback__ = property(lambda self: None, lambda self, value: None)


def check_rules(workflow: Any, known: KnownResults, unseen: Iterable[str]) -> None:
    """Check a job of each rule, and raise `RefusedError` with a sentence for each fault.

    Rules that write nothing into the results directory may be anything.
    """
    first = {_what(job): job for job in reversed([*workflow.dag.jobs]) if job.output}
    faults = [
        f"the rule {name} {fault}"
        for (name, _), job in sorted(first.items())
        if (fault := _fault(job, known))
    ]
    faults += [
        f"{place}: fingerprints do not see what is there; import it, or give it to the rule as an "
        f"input or in params"
        for place in unseen
    ]
    if faults:
        raise RefusedError("\n".join([*faults, "docs/trust.md lists what rules may have"]))


def _what(job: Any) -> tuple[str, str]:
    """Rule and script of a job; jobs of a rule may have different scripts."""
    script = str(job.rule.script or "")
    if "{" in script:
        script = script.format(wildcards=job.wildcards, params=job.params, input=job.input)
    return job.rule.name, script


def _fault(job: Any, known: KnownResults) -> str:
    """Why results of a job's rule cannot be trusted; empty if they can."""
    rule, inside = job.rule, [str(path) in known for path in job.output]
    code = dict(job.params.items()).get("code")
    if not any(inside):
        place = f"has fingerprints of code, but writes outside of {known.results}"
        return f"{place}: let it write there" if isinstance(code, list) else ""
    if not all(inside):
        return f"writes into {known.results} and elsewhere: let it write into one of the two"
    script = _what(job)[1]
    for attribute, word in _KINDS.items():
        if getattr(rule, attribute, None) and not (script and attribute == "run_func_src"):
            return f"has {word}, whose results have no record: use a Python script with run_job"
    if rule.ruleinfo.cache:
        return "has cache:, which knows no records: give run_job a snaketrust.cache.Cache"
    for flag, reason in _FLAGS.items():
        if any(path.is_flagged(flag) for path in job.output if hasattr(path, "is_flagged")):
            return f"has the output {flag}(), {reason}"
    if not script.endswith(".py"):
        return f"runs {script or 'nothing'}, whose results have no record: use a Python script"
    if not isinstance(code, list):
        return "has no parameter code: give it code=sources.fingerprint(script)"
    for name, value in rule.params.items():
        arguments = inspect.signature(value).parameters if callable(value) else {}
        if arguments.keys() & {"threads", "resources"}:
            return f"derives {name} from threads or resources, which change no result: leave it out"
    try:
        for name, value in named(job.params).items():
            if type(value).__name__ != "TBDString":
                plain(value, f"params.{name}")
    except (TypeError, ValueError) as error:
        return f"has parameters that cannot be compared: {error}"
    modules = [str(entry).rpartition("@")[0] for entry in code]
    given = [name for name in modules if name.endswith(".py") and ":" not in name]
    if len(given) != 1:
        return f"has a module called py ({', '.join(given)}): call it otherwise"
    if Path(script).name != given[0]:
        return f"runs {Path(script).name}, but its code is the fingerprint of {given[0]}"
    return ""
