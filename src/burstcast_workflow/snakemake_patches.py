"""What Snakemake does otherwise than by itself; what it plans by is `burstcast_workflow.planning`.

Each function replaces one of Snakemake's own, for which there is no setting. With another version
of Snakemake this module and that one are what to look at.
"""

from collections.abc import Mapping, Sequence
from typing import Any, BinaryIO

import snakemake.api  # noqa: F401 - other modules of Snakemake cannot be imported before it
from snakemake.dag import DAG
from snakemake.exceptions import WorkflowError
from snakemake.persistence import PersistenceBase
from snakemake.rules import Rule
from snakemake.scheduling.job_scheduler import JobScheduler
from snakemake.script import PythonScript

from burstcast_workflow import code_hash
from burstcast_workflow.fingerprint import Sources
from burstcast_workflow.harness.run import OvertakenError, Run

DEFAULT_LIMIT = 100, 1
"""So many jobs start in so many seconds at the most, where nobody says otherwise."""

FIRST_LINE = (
    b"import signal; signal.getsignal(2) is signal.SIG_IGN or signal.signal(2, signal.SIG_DFL)\n"
)
"""What scripts begin with: SIGINT, 2, ends the process at once, unless it is ignored (nohup)."""

_stop_caching = PersistenceBase.deactivate_cache
_plan = DAG.init
_make_scheduler = JobScheduler.__init__
_group_of_job = Rule.expand_group
_write_script = PythonScript.write_script


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
                code_hash.keep(run.results)
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


def plan_without_idle_groups() -> None:
    """Leave jobs in no group where they run right here.

    Snakemake groups only what it submits, but plans by the groups all the same: it goes through all
    members of a group, and what lies between them, at each of its jobs.
    """

    def group_of_job(self: Rule, wildcards: Mapping[str, str]) -> str | None:
        return None if self.workflow.local_exec else _group_of_job(self, wildcards)

    Rule.expand_group = group_of_job


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


def interrupt_quietly() -> None:
    """Have Snakemake put `FIRST_LINE` before the scripts that it runs from now on.

    A job that Ctrl-C meets while it still imports ends without a traceback; later on
    `burstcast_workflow.harness.job.run_job` sees to it.
    """

    def write_script(self: Any, preamble: str, fd: BinaryIO) -> None:
        fd.write(FIRST_LINE)
        _write_script(self, preamble, fd)

    PythonScript.write_script = write_script
