"""What Snakemake knows of results that are there: their own records, and nothing else.

Snakemake keeps records of its own, by the paths of files, in the directory that it runs in. They
say nothing about files that were exchanged, restored, made by another copy of the project, or that
outlived that directory. Here it is told what the results' own records say instead
(`burstcast_workflow.harness.records`).
"""

import os
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import snakemake.api  # noqa: F401 - other modules of Snakemake cannot be imported before it
from snakemake.dag import DAG
from snakemake.exceptions import WorkflowError
from snakemake.persistence import RECORD_FORMAT_VERSION, MetadataRecord, PersistenceBase
from snakemake.scheduling.job_scheduler import JobScheduler

from burstcast_workflow.fingerprint import Sources
from burstcast_workflow.harness.records import Record, Records, digest
from burstcast_workflow.harness.run import OvertakenError, Run

FORMER = " as it was"
"""What is put after the path of an input whose content is not what a file was made from."""

DEFAULT_LIMIT = 100, 1
"""So many jobs start in so many seconds at the most, where nobody says otherwise."""

_snakemakes_own = PersistenceBase.metadata
_marked_incomplete = PersistenceBase.incomplete
_stop_caching = PersistenceBase.deactivate_cache
_plan = DAG.init
_make_scheduler = JobScheduler.__init__


def claim_before_jobs(
    run: Run, config: Mapping[str, Any], sources: Sources, directories: Sequence[str]
) -> None:
    """Let a run take its results directory as soon as it does more than planning.

    Snakemake's handlers are not called where the workflow is a module of another one; that its
    planning is over it tells its records, too.

    Parameters
    ----------
    run
        The run.
    config, sources
        What is planned: the whole config and the code.
    directories
        Where jobs find modules of the user's own.
    """

    def planning_is_over(self: PersistenceBase) -> None:
        _stop_caching(self)
        if any(True for _ in self.dag.needrun_jobs()):
            code = sources.all_fingerprints()
            try:
                run.claim(config, code, directories)
            except OvertakenError as error:
                raise WorkflowError(str(error)) from None

    PersistenceBase.deactivate_cache = planning_is_over


def refuse_what_nothing_makes(results: str) -> None:
    """Make it an error if the campaign needs a result that is there, but that no job makes.

    Snakemake takes such a file for a source, whether its name matches no rule or something is
    missing that it was made from, and has nothing to do.

    Parameters
    ----------
    results
        The results directory, as the rules spell it.
    """

    async def planned(self: DAG) -> None:
        await _plan(self)
        options = self.workflow.dag_settings
        if options.until or options.omit_from or options.batch or options.allowed_rules:
            return
        made = {str(path) for job in self.jobs for path in job.output}
        wanted = {str(path) for job in self.jobs for path in job.input}
        lost = sorted(path for path in wanted - made if path.startswith(f"{results}/"))
        if lost:
            more = f", as {len(lost) - 1} others" if len(lost) > 1 else ""
            raise WorkflowError(
                f"{lost[0]} is there, but nothing makes it{more}: its name matches no rule, or a "
                f"source file is missing that it comes from (without it, Snakemake says which)"
            )

    DAG.init = planned


def start_jobs_without_delay() -> None:
    """Lift Snakemake's own limit on the jobs that start in a second, where they run right here.

    Under a limit, Snakemake looks through all jobs that are ready a second after each such look,
    beside the look when a job has ended. So each job that ends adds a look to every second from
    then on: after some hundred jobs Snakemake itself keeps a core busy. A limit that a person has
    set is kept.
    """

    def without_default_limit(self: JobScheduler, workflow: Any, *arguments: Any) -> None:
        _make_scheduler(self, workflow, *arguments)
        limit = self.job_rate_limiter
        if workflow.local_exec and limit and (limit.max_jobs, limit.timespan) == DEFAULT_LIMIT:
            self.job_rate_limiter = None

    JobScheduler.__init__ = without_default_limit


def plan_by_records(results: str) -> None:
    """Let Snakemake plan by the records of a results directory.

    Parameters
    ----------
    results
        The directory, as the rules spell it.
    """
    records = Records(results)

    @cache
    def found(path: str, _changed: int) -> tuple[Record | None, str]:
        return records.found(path)

    def content(path: str) -> str | None:
        """Digest of a file as it is now; None if it is not there, or damaged."""
        if not os.path.exists(path):
            return None
        if not path.startswith(f"{results}/"):
            return digest(path)
        record, _ = found(path, os.stat(path).st_mtime_ns)
        return None if record is None else record.digest

    @cache
    def known(path: str, changed: int) -> MetadataRecord:
        record, problem = found(path, changed)
        if record is None:
            # parameters that no job has: it runs again, and Snakemake says why
            return MetadataRecord(record_format_version=RECORD_FORMAT_VERSION, params=[problem])
        inputs = {records.path(name): value for name, value in record.inputs.items()}
        return MetadataRecord(
            record_format_version=RECORD_FORMAT_VERSION,
            rule=record.identity["rule"],
            params=sorted(map(repr, record.parameters.values())),
            input=sorted(
                path if content(path) in (value, None) else path + FORMER
                for path, value in inputs.items()
            ),
            input_checksums={path: f"sha256:{value}" for path, value in inputs.items()},
            log=[records.path(record.log)],
            starttime=changed / 1e9 - record.seconds,
            endtime=changed / 1e9,
        )

    def metadata(self: PersistenceBase, target: Any) -> MetadataRecord | None:
        path = str(target)
        if not path.startswith(f"{results}/"):
            return _snakemakes_own(self, target)
        return known(path, os.stat(path).st_mtime_ns) if os.path.exists(path) else None

    async def incomplete(self: PersistenceBase, job: Any) -> list[Any]:
        """Outputs that were being made when Snakemake was killed, and were not finished since."""
        marked = await _marked_incomplete(self, job)
        return [file for file in marked if (made := metadata(self, file)) is None or not made.rule]

    PersistenceBase.metadata = metadata
    PersistenceBase.incomplete = incomplete
