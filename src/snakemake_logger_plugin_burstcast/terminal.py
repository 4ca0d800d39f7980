"""Terminal output of a run: progress, time left, and failures.

A line that renews itself in a terminal; elsewhere a line now and then. All else is in Snakemake's
own log, `.snakemake/log`. `profiles/default` chooses this handler of Snakemake's logger. Snakemake
imports it in whatever directory it runs, so that it relies on nothing else of burstcast.
"""

import logging
import shutil
import sys
import threading
import time
from collections.abc import Mapping
from pathlib import Path
from typing import TextIO

from snakemake.logging import DefaultFormatter
from snakemake_interface_logger_plugins.base import LogHandlerBase
from snakemake_interface_logger_plugins.common import LogEvent

from snakemake_logger_plugin_burstcast.config_files import unreadable_config

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

_expected: dict[int, tuple[str, float]] = {}
_basis: list[str] = []
_interruption = threading.Event()


def expect(jobs: Mapping[int, tuple[str, float]], basis: str = "") -> None:
    """Take note of the jobs of this run, by their numbers: the rule, and the predicted seconds.

    ``basis``: What the prediction is based on, in words.
    """
    _expected.clear()
    _expected.update(jobs)
    _basis[:] = [basis] if basis else []


def interrupted() -> bool:
    """Whether a person has stopped this run."""
    return _interruption.is_set()


class Progress:
    """Progress of a run on some cores, and the time left.

    Jobs are expected to take what is predicted, as many times as finished jobs of their rule did.
    """

    def __init__(
        self, expected: Mapping[int, tuple[str, float]], cores: int, started: float
    ) -> None:
        self._expected, self._cores, self._started = dict(expected), max(1, cores), started
        self._done, self._share = 0.0, 0.0
        self._begun: dict[int, float] = {}
        # of each rule: seconds that its finished jobs took, their prediction, and that of the rest
        self._rules: dict[str, tuple[float, float, float]] = {}
        for rule, predicted in expected.values():
            self._count(rule, left=predicted)
        self.jobs, self.finished = len(self._expected), 0

    def _count(self, rule: str, took: float = 0.0, done: float = 0.0, left: float = 0.0) -> None:
        known = self._rules.get(rule, (0.0, 0.0, 0.0))
        self._rules[rule] = known[0] + took, known[1] + done, known[2] + left

    def start(self, job: int, now: float) -> None:
        """Take note that a job has started, perhaps once more."""
        self._begun[job] = now

    def finish(self, job: int, now: float) -> None:
        """Count a job that is done; targets are no jobs."""
        if job in self._expected:
            rule, predicted = self._expected.pop(job)
            took = now - self._begun.pop(job, now)
            self._count(rule, took, predicted, -predicted)
            self._done += took
            self.finished += 1

    def _ratio(self, rule: str) -> float:
        """How many times the predicted time the finished jobs of a rule took; 1 without any."""
        took, predicted, _ = self._rules[rule]
        return took / predicted if predicted else 1.0

    @property
    def _left(self) -> float:
        """Seconds on one core that all unfinished jobs are expected to take."""
        return sum(self._ratio(rule) * left for rule, (_, _, left) in self._rules.items())

    @property
    def share(self) -> float:
        """Share of the work that is done, from 0 to 1; it never falls."""
        whole = self._done + self._left
        self._share = max(self._share, self._done / whole if whole else 0.0)
        return self._share

    def remaining(self, now: float) -> float:
        """Seconds that the rest takes: as expected, and more and more by the pace of the run."""
        running = sum(
            min(now - begun, _NEARLY * self._ratio(rule) * predicted)
            for job, begun in self._begun.items()
            for rule, predicted in [self._expected.get(job, ("", 0.0))]
            if rule
        )
        left, done = self._left - running, self._done + running
        if not self._done:
            return left / self._cores
        pace = (now - self._started) / done
        return left * ((1.0 - self.share) / self._cores + self.share * pace)

    def line(self, now: float) -> str:
        """Progress line: share done, jobs, time left."""
        done = f"{self.share:4.0%}  {self.finished} of {counted(self.jobs)}"
        if self.finished >= self.jobs:
            return done
        return f"{done}, about {duration(self.remaining(now))} left"


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
        self._said = time.monotonic()
        self._progress: Progress | None = None
        self._cores = 1
        self._last_share = 0.0

    def emit(self, record: logging.LogRecord) -> None:
        """Show a message, or leave it to the log."""
        event = getattr(record, "event", None)
        try:
            if self.common_settings.dryrun or record.levelno < logging.INFO:
                self._say(self.format(record))
            elif event is None or event == LogEvent.ERROR:
                self._message(record)
            else:
                self._event(event, record)
        except Exception:
            self.handleError(record)

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
                cores = "1 core" if self._cores == 1 else f"{self._cores} cores"
                plan = f"{counted(self._progress.jobs)}, about {duration(seconds)} on {cores}"
                self._say(", ".join([plan, *_basis]))
                threading.Thread(target=self._beat, daemon=True).start()
            if fields["output"]:  # a target has none
                job, now = fields["jobid"], time.monotonic()
                self._labels[job] = (fields["rule_msg"] or fields["rule_name"], now)
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
        line = self._progress.line(time.monotonic())
        if self._live:
            width = shutil.get_terminal_size().columns - 1
            self._stream.write(f"\r\x1b[K{f'{line}  {self._running()}'.strip()[:width]}")
            self._stream.flush()
            self._said = time.monotonic()
        elif (
            self._progress.share >= self._last_share + SHARE_OF_A_LINE
            or self._progress.finished == self._progress.jobs
        ):
            self._last_share = self._progress.share
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
        if self._labels and now - self._said >= _HEARTBEAT[self._live] and not interrupted():
            if self._live:
                self._show()
            else:
                self._say(f"{self._progress.line(now)}  {self._running()}")

    def _say(self, text: str) -> None:
        """Write lines that stay, above the line of progress."""
        self._said = time.monotonic()
        self._stream.write(f"\r\x1b[K{text}\n" if self._live else f"{text}\n")
        self._stream.flush()
