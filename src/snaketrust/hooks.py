"""Changes to Snakemake: four of its functions are replaced, for which there is no setting.

`HOOKS` lists them with the reasons. With a release of Snakemake that is not among `TESTED` a run
warns, and continues if the functions have the same parameters. If they differ, it does without the
replacements that only save time or lines on the terminal, and refuses to start without the others.
"""

import inspect
import logging
from collections.abc import Callable, Sequence
from typing import Any, BinaryIO, NamedTuple

import snakemake.api  # noqa: F401 - other modules of Snakemake cannot be imported before it
from snakemake.common import __version__
from snakemake.exceptions import WorkflowError
from snakemake.persistence import RECORD_FORMAT_VERSION, MetadataRecord, PersistenceBase
from snakemake.scheduling.job_scheduler import JobScheduler
from snakemake.script import PythonScript

from snaketrust.planning import KnownResults

logger = logging.getLogger(__name__)

TESTED = ("9.20.0", "9.23.1", "9.25.2", "9.27.1")
"""Releases of Snakemake that the tests of this package were run with."""

DEFAULT_LIMIT = 100, 1
"""Default of Snakemake's limit: number of jobs that may start, in how many seconds."""

FIRST_LINE = (
    b"import signal; signal.getsignal(2) is signal.SIG_IGN or signal.signal(2, signal.SIG_DFL)\n"
)
"""What scripts begin with: SIGINT, 2, ends the process at once, unless it is ignored (nohup)."""

_FORMER = " as it was"  # put after the path of an input that is not what a file was made from


class UnfitSnakemakeError(WorkflowError):  # type: ignore[misc]
    """Snakemake is not what this package knows any more."""


class Hook(NamedTuple):
    """A function of Snakemake that is replaced.

    Attributes
    ----------
    owner, name
        Which function.
    own
        Snakemake's own.
    parameters
        Names of its parameters.
    reason
        What it is replaced for.
    without
        What happens where it is not replaced; empty if nothing can be trusted then.
    """

    owner: Any
    name: str
    own: Any
    parameters: tuple[str, ...]
    reason: str
    without: str = ""

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

    Parameters
    ----------
    known
        What is known of results.
    planning_is_over
        Called with Snakemake's workflow when it knows all jobs, in a dry run, too.

    Raises
    ------
    UnfitSnakemakeError
        If this release of Snakemake has one of the functions no more that nothing goes without.
    """
    replacements: Sequence[Callable[..., Any]] = metadata_of, _scheduler, _incomplete, _write_script
    if __version__ not in TESTED:
        releases = ", ".join(TESTED)
        logger.warning("Snakemake %s is none of the tested releases (%s)", __version__, releases)
    for hook, replacement in zip(HOOKS, replacements, strict=True):
        function = f"{hook.owner.__name__}.{hook.name}"
        if hook.fits():
            setattr(hook.owner, hook.name, replacement(hook.own, known, planning_is_over))
        elif hook.without:
            logger.warning("Snakemake has another %s now: %s", function, hook.without)
        else:
            raise UnfitSnakemakeError(
                f"Snakemake {__version__} has another {function}, on which it rests which results "
                f"are believed: install one of the releases {', '.join(TESTED)}"
            )


def plan_by(known: KnownResults) -> None:
    """Replace only what Snakemake plans by, as in the process of a single job."""
    PersistenceBase.metadata = metadata_of(HOOKS[0].own, known)


def metadata_of(own: Any, known: KnownResults, *_: object) -> Callable[..., MetadataRecord | None]:
    """Replace Snakemake's metadata of results by their records."""
    told: dict[str, tuple[object, MetadataRecord | None]] = {}

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


def record_of(known: KnownResults, path: str) -> MetadataRecord | None:
    """Record of a result in the form of Snakemake's own."""
    record, problem, changed = known.of(path)
    if record is None:
        # parameters that no job has: it runs again, and Snakemake says why
        version = RECORD_FORMAT_VERSION
        return MetadataRecord(record_format_version=version, params=[problem]) if problem else None
    inputs, end = known.inputs(record), (changed or 0) / 1e9
    digests = {known.records.path(name): value for name, value in record.inputs.items()}
    return MetadataRecord(
        record_format_version=RECORD_FORMAT_VERSION,
        rule=record.identity["rule"],
        params=sorted(map(repr, record.parameters.values())),
        input=sorted(name if fits else name + _FORMER for name, fits in inputs.items()),
        input_checksums={name: f"sha256:{value}" for name, value in digests.items()},
        log=[known.records.path(record.log)] if record.log else [],
        starttime=end - record.seconds,
        endtime=end,
    )


def _scheduler(own: Any, _: KnownResults, planning_is_over: Callable[[Any], None]) -> Any:
    """Actions when planning is over."""

    def make(self: JobScheduler, workflow: Any, *arguments: Any, **options: Any) -> None:
        planning_is_over(workflow)
        own(self, workflow, *arguments, **options)
        limit = self.job_rate_limiter
        if workflow.local_exec and limit and (limit.max_jobs, limit.timespan) == DEFAULT_LIMIT:
            self.job_rate_limiter = None

    return make


def _incomplete(own: Any, known: KnownResults, *_: object) -> Any:
    """Outputs that were being made when Snakemake was killed, and were not finished since."""

    async def incomplete(self: PersistenceBase, job: Any) -> list[Any]:
        marked = await own(self, job)
        return [path for path in marked if str(path) not in known or not known.of(path).record]

    return incomplete


def _write_script(own: Any, *_: object) -> Any:
    """Put `FIRST_LINE` before the scripts that Snakemake runs from now on."""

    def write_script(self: Any, preamble: str, fd: BinaryIO) -> None:
        fd.write(FIRST_LINE)
        own(self, preamble, fd)

    return write_script
