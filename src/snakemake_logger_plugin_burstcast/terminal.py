"""Terminal output of a run: progress, time left, and failures.

A line that renews itself in a terminal; elsewhere a line now and then. All else is in Snakemake's
own log, `.snakemake/log`. `profiles/default` chooses this handler of Snakemake's logger. Snakemake
imports it in whatever directory it runs, so that it relies on nothing else of burstcast.
"""

import logging
import re
import shutil
import sys
import threading
import time
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, TextIO

from snakemake.logging import DefaultFormatter
from snakemake.settings.enums import Quietness
from snakemake_interface_logger_plugins.base import LogHandlerBase
from snakemake_interface_logger_plugins.common import LogEvent

from snakemake_logger_plugin_burstcast.config_files import unreadable_config
from snakemake_logger_plugin_burstcast.reasons import PlannedJob, explanation

SHARE_OF_A_LINE = 0.04
"""Without a terminal, a line of progress is written when this share more is done."""

# Seconds without a line after which one names the jobs that run, in a terminal and elsewhere.
_HEARTBEAT = {True: 2.0, False: 60.0}
# A job that takes longer than predicted counts as nearly done.
_NEARLY = 0.95

# Of what Snakemake itself says, the information that a person wants.
_WANTED = ("Nothing to be done", "Unlocking", "Removing", "Trying to restart", "Touching")
# That a job has failed is said once, when it does; these say it again, or where in Snakemake.
_REPETITIONS = (
    "CalledProcessError",
    "RuleException",
    "SystemExit",
    "Exiting because a job execution failed",
    "WorkflowError:\nAt least one job did not complete successfully",
    "At least one job did not complete successfully",
    "Removing output files of failed job",
    "Full Traceback",
)
_INTERRUPTION = ("Terminating processes on user request", "Cancelling snakemake on user request")

# Where in burstcast's rules a message was raised, which is about the config.
_RAISED = re.compile(r'WorkflowError in file "[^"]*rules/common\.smk", line \d+:\n')
_PLACE = re.compile(r'\n  File "[^"]*", line \d+, in \S+')

_expected: dict[int, tuple[str, float | None]] = {}
_interruption = threading.Event()


def expect(jobs: Iterable[Any], seconds: Mapping[str, float]) -> None:
    """Take note of the jobs of this run, and of the seconds that earlier jobs of rules took."""
    _expected.clear()
    names = {job.jobid: job.rule.name for job in jobs if job.output}
    _expected.update({number: (rule, seconds.get(rule)) for number, rule in names.items()})


def interrupted() -> bool:
    """Whether a person has stopped this run."""
    return _interruption.is_set()


class Progress:
    """Progress of a run on some cores, and the time left.

    A job is expected to take what finished jobs of its rule took; without any, what such jobs took
    in earlier runs; and without these, what all finished jobs took.

    ``expected``: Rule of each job, and seconds of earlier jobs of that rule, if there were any.
    """

    def __init__(
        self, expected: Mapping[int, tuple[str, float | None]], cores: int, started: float
    ) -> None:
        self._expected, self._cores, self._started = dict(expected), max(1, cores), started
        self._begun: dict[int, float] = {}
        self._took: dict[str, list[float]] = {}  # by the finished jobs of each rule
        self._done, self._share = 0.0, 0.0
        self.jobs, self.finished = len(self._expected), 0

    def start(self, job: int, now: float) -> None:
        """Take note that a job has started, perhaps once more."""
        self._begun[job] = now

    def finish(self, job: int, now: float) -> None:
        """Count a job that is done; targets are no jobs."""
        if job in self._expected:
            rule, _ = self._expected.pop(job)
            took = now - self._begun.pop(job, now)
            self._took.setdefault(rule, []).append(took)
            self._done += took
            self.finished += 1

    def _seconds(self, rule: str, earlier: float | None) -> float | None:
        """Seconds that a job of a rule is expected to take; None: nothing is known yet."""
        if took := self._took.get(rule):
            return sum(took) / len(took)
        if earlier is None and self.finished:
            return self._done / self.finished
        return earlier

    def _left(self, now: float) -> float | None:
        """Seconds on one core that all unfinished jobs take; None: nothing is known yet."""
        left = 0.0
        for job, (rule, earlier) in self._expected.items():
            seconds = self._seconds(rule, earlier)
            if seconds is None:
                return None
            running = now - self._begun[job] if job in self._begun else 0.0
            # a job that takes longer than expected goes on as long as it has taken suggests
            left += max(seconds - running, (1 - _NEARLY) * max(seconds, running))
        return left

    def share(self, now: float) -> float:
        """Share of the work that is done, from 0 to 1; it never falls."""
        left = self._left(now)
        if left is not None:
            running = sum(now - begun for job, begun in self._begun.items())
            whole = self._done + running + left
            now_done = (self._done + running) / whole if whole else 0.0
            self._share = max(self._share, now_done)
        return self._share

    def remaining(self, now: float) -> float | None:
        """Seconds that the rest takes: as expected, and more and more by the pace of the run."""
        left = self._left(now)
        if left is None:
            return None
        done = self._done + sum(now - begun for begun in self._begun.values())
        pace = (now - self._started) / done if done else 1.0 / self._cores
        share = self.share(now)
        return left * ((1.0 - share) / self._cores + share * pace)

    def line(self, now: float) -> str:
        """Progress line: share done, jobs, time left."""
        done = f"{self.share(now):4.0%}  {self.finished} of {counted(self.jobs)}"
        left = self.remaining(now) if self.finished < self.jobs else None
        return done if left is None else f"{done}, about {duration(left)} left"


def counted(jobs: int) -> str:
    """Number of jobs in words: "1 job", "2 jobs"."""
    return f"{jobs} job{'' if jobs == 1 else 's'}"


def duration(seconds: float) -> str:
    """Seconds as a person reads them: 40 s, 3 min 20 s, 2 h 05 min."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02} s"
    return f"{whole // 3600} h {whole % 3600 // 60:02} min"


def _label(fields: Mapping[str, Any]) -> str:
    """A job as a person reads it: train Re400 esn-N500-RV-seed0."""
    return " ".join([fields["rule_name"], *map(str, dict(fields["wildcards"]).values())])


class TerminalHandler(LogHandlerBase):
    """Writes what a person wants to see of Snakemake's messages."""

    writes_to_stream = True
    writes_to_file = False
    has_filter = False
    has_formatter = True
    needs_rulegraph = False

    def __post_init__(self) -> None:
        if Path(sys.argv[0]).stem == "snakemake" and (wrong := unreadable_config(sys.argv[1:])):
            raise SystemExit(wrong)
        self.setFormatter(DefaultFormatter(self.common_settings.quiet, False))
        self._stream: TextIO = sys.stdout if self.common_settings.stdout else sys.stderr
        self._live = self._stream.isatty()
        self._labels: dict[int, tuple[str, float]] = {}
        self._written_at = time.monotonic()
        self._progress: Progress | None = None
        self._cores = 1
        self._last_share = 0.0
        self._planned: list[PlannedJob] = []
        self._table = ""  # Snakemake's own, of the jobs of each rule

    def emit(self, record: logging.LogRecord) -> None:
        """Show a message, or leave it to the log."""
        event = getattr(record, "event", None)
        try:
            if self.common_settings.dryrun and not self.common_settings.verbose:
                self._plan(event, record)
            elif self.common_settings.dryrun or record.levelno < logging.INFO:
                self._say(self.format(record))
            elif event is None or event == LogEvent.ERROR:
                self._message(record)
            else:
                self._event(event, record)
        except Exception:
            self.handleError(record)

    def _plan(self, event: str | None, record: logging.LogRecord) -> None:
        """Collect the jobs of a dry run; at its end, say what they would run for."""
        fields = record.__dict__
        if event == LogEvent.JOB_INFO:
            if fields["output"]:  # a target has none
                case = dict(fields["wildcards"]).get("case", "")
                files = fields["input"] or (), fields["output"]
                job = PlannedJob(fields["rule_name"], case, *files, fields["reason"])
                self._planned.append(job)
        elif event == LogEvent.RUN_INFO:
            self._table = self.format(record).strip()
        elif record.getMessage().startswith("This was a dry-run"):
            if Quietness.RULES in (self.common_settings.quiet or ()):
                self._say(self._table)  # Snakemake gives no reasons then
            else:
                each = "\n(each job: snakemake -n --verbose)" if self._planned else ""
                self._say(f"{explanation(self._planned)}{each}")
        elif event == LogEvent.ERROR or record.levelno >= logging.WARNING:
            self._say(self.format(record))
        elif record.getMessage().startswith(_WANTED):
            self._say(record.getMessage().strip())

    def _message(self, record: logging.LogRecord) -> None:
        text = record.getMessage().strip()
        if text.startswith(_INTERRUPTION):
            if not interrupted():
                _interruption.set()
                self._say("interrupted; what is done stays, the same command goes on from here")
        elif record.levelno >= logging.WARNING:
            if not interrupted() and not text.startswith(_REPETITIONS):
                self._say(text)
        elif text.startswith(_WANTED) and not text.startswith(_REPETITIONS):
            self._say(text)

    def _event(self, event: str, record: logging.LogRecord) -> None:
        fields = record.__dict__
        if event == LogEvent.RESOURCES_INFO:
            self._cores = fields.get("cores", self._cores)
        elif event == LogEvent.JOB_INFO:
            # the first job: by now the plan is known
            if self._progress is None:
                self._progress = Progress(_expected, self._cores, time.monotonic())
                seconds = self._progress.remaining(time.monotonic())
                about = "" if seconds is None else f", about {duration(seconds)}"
                cores = "1 core" if self._cores == 1 else f"{self._cores} cores"
                self._say(f"{counted(self._progress.jobs)}{about} on {cores}")
                threading.Thread(target=self._beat, daemon=True).start()
            if fields["output"]:  # a target has none
                job, now = fields["jobid"], time.monotonic()
                self._labels[job] = (_label(fields), now)
                self._progress.start(job, now)
                self._show()
        elif event == LogEvent.JOB_FINISHED and self._progress is not None:
            self._progress.finish(fields["job_id"], time.monotonic())
            if self._labels.pop(fields["job_id"], None) is not None:
                self._show()
        elif event == LogEvent.JOB_ERROR:
            what, _ = self._labels.pop(fields["jobid"], (fields["rule_name"], 0.0))
            if not interrupted():
                logs = ", ".join(fields["log"] or ())
                self._say(f"FAILED  {what}" + (f" (log: {logs})" if logs else ""))
        elif event == LogEvent.GROUP_ERROR and not interrupted():
            self._say(self.format(record))

    def _show(self) -> None:
        """Renew the line of progress, or write one if there is enough to tell."""
        assert self._progress is not None
        now = time.monotonic()
        line, share = self._progress.line(now), self._progress.share(now)
        if self._live:
            width = shutil.get_terminal_size().columns - 1
            text = f"{line}  {self._running()}".strip()
            self._stream.write(f"\r\x1b[K{text[:width]}")
            self._stream.flush()
            self._written_at = time.monotonic()
        elif (
            share >= self._last_share + SHARE_OF_A_LINE
            or self._progress.finished == self._progress.jobs
        ):
            self._last_share = share
            self._say(line)

    def _running(self) -> str:
        """Jobs that run, with the time for which they do."""
        now = time.monotonic()
        return ", ".join(
            f"{what} ({duration(now - begun)})" for what, begun in self._labels.values()
        )

    def _beat(self) -> None:
        """Name the jobs that run where nothing has been written for a while."""
        while self._progress is not None and self._progress.finished < self._progress.jobs:
            time.sleep(_HEARTBEAT[self._live])
            with self.lock:  # type: ignore[union-attr]
                self.beat()

    def beat(self) -> None:
        """Renew the line of progress, or write one with what runs after a silent minute."""
        assert self._progress is not None
        now = time.monotonic()
        if self._labels and now - self._written_at >= _HEARTBEAT[self._live] and not interrupted():
            if self._live:
                self._show()
            else:
                self._say(f"{self._progress.line(now)}  {self._running()}")

    def _say(self, text: str) -> None:
        """Write lines that stay, above the line of progress, without where rules raise messages."""
        self._written_at = time.monotonic()
        if _RAISED.match(text):
            text = _PLACE.sub("", _RAISED.sub("", text))
        self._stream.write(f"\r\x1b[K{text}\n" if self._live else f"{text}\n")
        self._stream.flush()
