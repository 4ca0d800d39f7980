"""Changes to Snakemake: nine of its functions are replaced, for which there is no setting.

`HOOKS` lists them with the reasons. With a release of Snakemake that is not among `TESTED` a run
warns, and continues if the functions have the same parameters. If they differ, it does without the
replacements that only save time or lines on the terminal, and refuses to start without the others.
"""

import inspect
import logging
import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from typing import Any, BinaryIO, NamedTuple

import snakemake.api  # noqa: F401 - other modules of Snakemake cannot be imported before it
from snakemake.common import __version__
from snakemake.dag import DAG
from snakemake.exceptions import WorkflowError
from snakemake.jobs import Job
from snakemake.persistence import (
    RECORD_FORMAT_VERSION,
    MetadataRecord,
    ParamsChange,
    PersistenceBase,
)
from snakemake.scheduling.job_scheduler import JobScheduler
from snakemake.script import PythonScript

from snaketrust.checks import RefusedError
from snaketrust.planning import Jobs, KnownResults
from snaketrust.run import OvertakenError, Run, check_ownership

logger = logging.getLogger(__name__)

TESTED = ("9.20.0", "9.23.1", "9.25.2", "9.27.1")
"""Releases of Snakemake that the tests of this package were run with."""

DEFAULT_LIMIT = 100, 1
"""Default of Snakemake's limit: number of jobs that may start, in how many seconds."""

FIRST_LINE = (
    b"import signal; signal.getsignal(2) is signal.SIG_IGN or signal.signal(2, signal.SIG_DFL)\n"
)
"""What scripts begin with: SIGINT, 2, ends the process at once, unless it is ignored (nohup)."""


class UnfitSnakemakeError(WorkflowError):  # type: ignore[misc]
    """Snakemake is not what this package knows any more."""


class Hook(NamedTuple):
    """A function of Snakemake that is replaced."""

    owner: Any
    name: str
    own: Any  # Snakemake's own function
    parameters: tuple[str, ...]  # their names
    reason: str  # what it is replaced for
    without: str = ""  # what happens where it is not; empty if nothing can be trusted then

    def fits(self) -> bool:
        """Whether this release of Snakemake has the function as it is known here."""
        return self.own is not None and self.parameters == tuple(
            inspect.signature(self.own).parameters
        )


HOOKS = (
    Hook(
        PersistenceBase,
        "metadata",
        getattr(PersistenceBase, "metadata", None),
        ("self", "target"),
        "what is planned rests on the records of results, not on what Snakemake noted",
    ),
    Hook(
        PersistenceBase,
        "params_changed",
        getattr(PersistenceBase, "params_changed", None),
        ("self", "job", "file"),
        "parameters are compared with their names and in their order, in plain form",
    ),
    Hook(
        PersistenceBase,
        "_input_changed",
        getattr(PersistenceBase, "_input_changed", None),
        ("self", "job", "file"),
        "inputs are compared in their order, by content, whatever their paths are spelt like",
    ),
    Hook(
        Job,
        "remove_existing_output",
        getattr(Job, "remove_existing_output", None),
        ("self",),
        "a group that is submitted again keeps what its members have finished; a run that another "
        "has overtaken removes nothing",
        "all members of such a group run again; an overtaken run makes jobs of the other fail",
    ),
    Hook(
        Job,
        "cleanup",
        getattr(Job, "cleanup", None),
        ("self", "skip_outputs"),
        "where a member of a group has failed, the results of the others stay",
        "all members of such a group run again",
    ),
    Hook(
        DAG,
        "check_output_mtime",
        getattr(DAG, "check_output_mtime", None),
        ("self", "job", "expanded_output"),
        "a result that a slow clock dates before its inputs is dated as they are",
        "such jobs fail",
    ),
    Hook(
        JobScheduler,
        "__init__",
        getattr(JobScheduler, "__init__", None),
        ("self", "workflow", "executor_plugin", "scheduler", "greedy_scheduler_settings"),
        "planning is over: the run takes its results directory before any job; on this machine "
        "jobs start without the default limit in time, under which each job that ends adds a look "
        "at all jobs to every second from then on",
    ),
    Hook(
        PersistenceBase,
        "incomplete",
        getattr(PersistenceBase, "incomplete", None),
        ("self", "job"),
        "an output that a killed Snakemake has marked as incomplete is complete if its job has "
        "written its record since",
        "such jobs run again",
    ),
    Hook(
        PythonScript,
        "write_script",
        getattr(PythonScript, "write_script", None),
        ("self", "preamble", "fd"),
        "a job that Ctrl-C meets while it still imports ends without a traceback",
        "tracebacks on the terminal after Ctrl-C",
    ),
)


def install(known: KnownResults, planning_is_over: Callable[[Any], None]) -> None:
    """Replace what `HOOKS` lists.

    ``planning_is_over`` is called with Snakemake's workflow when it knows all jobs, in a dry run,
    too. `UnfitSnakemakeError` if this release lacks a function without which nothing is trusted.
    """
    jobs = Jobs(known)
    replacements: Sequence[Callable[..., Any]] = (
        *_OF_JOBS,
        *(_scheduler, _incomplete, _write_script),
    )
    if __version__ not in TESTED:
        releases = ", ".join(TESTED)
        logger.warning("Snakemake %s is none of the tested releases (%s)", __version__, releases)
    for hook, replacement in zip(HOOKS, replacements, strict=True):
        function = f"{hook.owner.__name__}.{hook.name}"
        if hook.fits():
            setattr(hook.owner, hook.name, replacement(hook.own, jobs, planning_is_over))
        elif hook.without:
            logger.warning("Snakemake has another %s now: %s", function, hook.without)
        else:
            raise UnfitSnakemakeError(
                f"Snakemake {__version__} has another {function}, on which it rests which results "
                f"are believed: install one of the releases {', '.join(TESTED)}"
            )


def plan_by(known: KnownResults) -> None:
    """Replace only what Snakemake plans and removes by, as in the process of a single job."""
    jobs = Jobs(known)
    for hook, replacement in zip(HOOKS, _OF_JOBS, strict=False):
        if hook.fits():
            setattr(hook.owner, hook.name, replacement(hook.own, jobs))


def metadata_of(own: Any, jobs: Jobs, *_: object) -> Callable[..., MetadataRecord | None]:
    """Replace Snakemake's metadata of results by their records."""
    told: dict[str, tuple[object, MetadataRecord | None]] = {}
    known = jobs.known

    def metadata(self: PersistenceBase, target: Any) -> MetadataRecord | None:
        path = str(target)
        if path not in known:
            found: MetadataRecord | None = own(self, target)
            return found
        one = known.of(path)
        if path not in told or told[path][0] is not one:
            told[path] = one, record_of(known, path)
        return told[path][1]

    return metadata


class _Checksums(dict[str, str]):
    """Digests of inputs by any spelling of their paths."""

    def __init__(self, known: KnownResults, digests: Mapping[str, str]) -> None:
        super().__init__(digests)
        self._name = known.records.name

    def get(self, path: str, default: Any = None) -> Any:
        value = super().get(self._name(str(path)), default)
        return value and f"sha256:{value}"


def record_of(known: KnownResults, path: str) -> MetadataRecord | None:
    """Record of a result in the form of Snakemake's own."""
    record, problem, state = known.of(path)
    if record is None:
        return MetadataRecord(record_format_version=RECORD_FORMAT_VERSION) if problem else None
    end = state[1] / 1e9 if state else 0.0
    found = MetadataRecord(
        record_format_version=RECORD_FORMAT_VERSION,
        rule=record.identity["rule"],
        log=[known.records.path(record.log)] if record.log else [],
        starttime=end - record.seconds,
        endtime=end,
    )
    found.input_checksums = _Checksums(known, record.inputs)
    return found


def _params_changed(own: Any, jobs: Jobs, *_: object) -> Any:
    """Compare parameters, names of files and wildcards with those of the records."""

    def params_changed(self: PersistenceBase, job: Any, file: Any = None) -> Any:
        files = job.output if file is None else [file]
        if any(str(path) not in jobs.known for path in files):
            return own(self, job, file)
        found = ParamsChange()
        for path in files:
            before, now = jobs.changed_parameters(job, str(path))
            found |= ParamsChange(only_old=before, only_new=now, files={path})
        return found

    return params_changed


def _input_changed(own: Any, jobs: Jobs, *_: object) -> Any:
    """Compare inputs with those of the records."""

    def input_changed(self: PersistenceBase, job: Any, file: Any = None) -> bool:
        if str(file) in jobs.known:
            return jobs.has_other_inputs(job, str(file))
        return bool(own(self, job, file))

    return input_changed


def _remove_existing_output(own: Any, jobs: Jobs, *_: object) -> Any:
    """Remove what a job is about to make, unless this run has made it, or is overtaken."""

    async def remove_existing_output(self: Job) -> None:
        try:
            check_ownership()
        except OvertakenError as error:
            raise RefusedError(str(error)) from None
        run = Run.current()
        if run is None or not jobs.known.records.made_by(run.token, [*map(str, self.output)]):
            await own(self)

    return remove_existing_output


def _cleanup(own: Any, jobs: Jobs, *_: object) -> Any:
    """Remove what a failed job leaves, but no results, and nothing of a newer run."""

    async def cleanup(self: Job, skip_outputs: Any) -> None:
        known = jobs.known
        with suppress(OvertakenError):
            check_ownership()
            results = {
                path for path in self.output if str(path) in known and known.of(str(path)).record
            }
            await own(self, {*skip_outputs, *results})

    return cleanup


def _check_output_mtime(own: Any, jobs: Jobs, *_: object) -> Any:
    """Date results no earlier than their inputs, whose times may be those of another clock."""

    async def check_output_mtime(self: DAG, job: Any, expanded_output: Any) -> None:
        read, made = ([*filter(os.path.exists, files)] for files in (job.input, expanded_output))
        newest = max((os.stat(path).st_mtime_ns for path in read), default=0)
        for path in made:
            if str(path) in jobs.known and os.stat(path).st_mtime_ns < newest:
                os.utime(path, ns=(newest, newest))
        await own(self, job, expanded_output)

    return check_output_mtime


_OF_JOBS = (
    *(metadata_of, _params_changed, _input_changed),
    *(_remove_existing_output, _cleanup, _check_output_mtime),
)
"""Replacements of the first of `HOOKS`, which the processes of jobs have, too."""


def _scheduler(own: Any, _: Jobs, planning_is_over: Callable[[Any], None]) -> Any:
    """Actions when planning is over."""

    def make(self: JobScheduler, workflow: Any, *arguments: Any, **options: Any) -> None:
        planning_is_over(workflow)
        own(self, workflow, *arguments, **options)
        limit = self.job_rate_limiter
        if workflow.local_exec and limit and (limit.max_jobs, limit.timespan) == DEFAULT_LIMIT:
            self.job_rate_limiter = None

    return make


def _incomplete(own: Any, jobs: Jobs, *_: object) -> Any:
    """Outputs that were being made when Snakemake was killed, and were not finished since."""

    async def incomplete(self: PersistenceBase, job: Any) -> list[Any]:
        marked, known = await own(self, job), jobs.known
        return [path for path in marked if str(path) not in known or not known.of(path).record]

    return incomplete


def _write_script(own: Any, *_: object) -> Any:
    """Put `FIRST_LINE` before the scripts that Snakemake runs from now on."""

    def write_script(self: Any, preamble: str, fd: BinaryIO) -> None:
        fd.write(FIRST_LINE)
        own(self, preamble, fd)

    return write_script
