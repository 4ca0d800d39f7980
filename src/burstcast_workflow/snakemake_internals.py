"""What burstcast needs of Snakemake beyond its documented interface, each with the reason.

`tests/workflow/test_snakemake_internals.py` fails where a version of Snakemake has changed it.
"""

import inspect
from collections.abc import Callable, Iterable
from typing import Any

from snakemake.common import overwrite_function_params
from snakemake.io import flag
from snakemake.iocontainers import Wildcards
from snakemake.output_index import OutputIndex
from snakemake.path_modifier import PATH_MODIFIER_FLAG

_PARAMETERS = inspect.signature(lambda wildcards: None).parameters


def of_wildcards(function: Callable[..., Any]) -> Callable[..., Any]:
    """Tell Snakemake the parameters of a function of wildcards.

    It would inspect them several times for each job, which takes longer than calling the function.
    """
    overwrite_function_params(function, _PARAMETERS)
    return function


def at_start(workflow: Any, act: Callable[[], None]) -> None:
    """Do something once jobs are about to run, before ``onstart`` of the Snakefile.

    The handlers of a workflow that others take as a module are not called. To be called while jobs
    are planned, when all files of rules are read.
    """
    others = workflow._onstart

    def start(log: str) -> None:
        act()
        others(log)

    workflow.onstart(start)


def for_each_job(workflow: Any, act: Callable[[Any, Any], None]) -> None:
    """Call a function of a rule and of wildcards for each job while jobs are planned.

    It is an input function without files: Snakemake has no other hook between reading the rules and
    deciding which jobs to run.
    """
    for rule in rules_of(workflow):
        if rule.output:
            rule.set_input(of_wildcards(_without_files(act, rule)))


def _without_files(act: Callable[[Any, Any], None], rule: Any) -> Callable[[Any], list[str]]:
    def files(wildcards: Any) -> list[str]:
        act(rule, wildcards)
        return []

    return files


def rules_of(workflow: Any) -> list[Any]:
    """Rules of burstcast, also where another workflow has them as a module."""
    return [rule for rule in workflow.rules if _is_ours(rule.module_globals)]


def _is_ours(names: Any) -> bool:
    return "campaign" in names and "stages" in names


def names_of_rules(workflow: Any) -> Any:
    """Names that the rules of burstcast know; None without rules of burstcast."""
    rules = rules_of(workflow) if workflow else []
    return rules[0].module_globals if rules else None


def force(workflow: Any, files: Iterable[str]) -> None:
    """Let the jobs that make files run, whatever Snakemake believes of these."""
    workflow.dag.forcefiles.update(files)


def recorded(workflow: Any, output: Any) -> tuple[list[str], dict[str, str]]:
    """Parameters, as texts, and digests of inputs that Snakemake has recorded of an output."""
    record = workflow.persistence.metadata(output)
    return (record.params or [], record.input_checksums or {}) if record else ([], {})


def outputs_of(rule: Any, wildcards: Any) -> list[Any]:
    """Outputs of a job."""
    return [path.apply_wildcards(wildcards) for path in rule.output]


def parameters_of(rule: Any, wildcards: Any) -> list[Any]:
    """Parameters of a job, of a rule whose functions of parameters take wildcards alone."""
    return [value(wildcards) if callable(value) else value for value in rule.params]


def all_files(workflow: Any, targets: Iterable[Any]) -> list[Any]:
    """All files that jobs make on the way to some targets, as inputs of another rule.

    Snakemake makes an intermediate file again only if a job that runs needs it.
    """
    index = OutputIndex(rules_of(workflow))
    files: dict[str, Any] = {}
    waiting = [*map(str, targets)]
    while waiting:
        target = waiting.pop()
        for rule in () if target in files else index.match_producers(target):
            wildcards = Wildcards(fromdict=rule.get_wildcards(target))
            files |= {str(path): path for path in outputs_of(rule, wildcards)}
            inputs, *_ = rule.expand_input(wildcards)
            waiting += map(str, inputs)
    # a prefix is in these paths already
    return [flag(path, PATH_MODIFIER_FLAG) for path in files.values()]


def is_in_storage(workflow: Any) -> bool:
    """Whether results lie in a storage, and here are only copies of them."""
    return workflow.storage_settings.default_storage_provider is not None


def jobs_with_sources(workflow: Any) -> dict[Any, set[Any]]:
    """All jobs of a plan, also where they would not run, and the jobs that each reads from."""
    dag = workflow.dag
    return {job: {*dag.dependencies[job]} for job in dag.jobs}


def planned_jobs(workflow: Any) -> Iterable[Any]:
    """Jobs that would run, after all are planned."""
    jobs: Iterable[Any] = workflow.dag.needrun_jobs()
    return jobs


def reasons_of_jobs(workflow: Any) -> list[tuple[Any, str]]:
    """Jobs that would run, each after the jobs that it reads from, with Snakemake's reason."""
    dag = workflow.dag
    return [
        (job, str(dag.reason(job)))
        for level in dag.toposorted()
        for job in sorted(level, key=lambda job: [job.rule.name, *map(str, job.output)])
        if dag.needrun(job)
    ]


def path_of_results(workflow: Any, results: str) -> str:
    """Path of the results below the prefix that another workflow gives a module."""
    path: str = workflow.modifier.path_modifier.replace_prefix(results)
    return path


def without_rate_limit(workflow: Any) -> None:
    """Lift the limit of job starts per second.

    With it, Snakemake looks at all ready jobs once more a second after each look: with each
    finished job more often, in the end all the time.
    """
    workflow.scheduler.job_rate_limiter = None
