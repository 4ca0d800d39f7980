"""What the logs of a run tell: the failed jobs, and how many took their results from the cache."""

from pathlib import Path

_MOST_JOBS = 10
_LAST_LINES = 12
_LAST_BYTES = 20_000
_DONE = " is done: "  # what `burstcast_workflow.harness.job.run_job` ends a log with
FROM_CACHE = "taken from the cache: "
"""How the line before that begins if the job has computed nothing."""


def cache_summary(rule_logs: Path, since: float) -> str:
    """How many of the jobs since a time have taken their results from the cache; empty if none."""
    logs = _written(rule_logs, since)
    taken = sum(FROM_CACHE in _end(path, 2) for path in logs)
    return f"{taken} of {len(logs)} jobs took their results from the cache." if taken else ""


def failure_summary(rule_logs: Path, scheduler_logs: Path, since: float) -> str:
    """Jobs that have failed since a time, with the last lines of their logs; empty without any.

    A job whose log does not end with its success has failed, or was killed: by a person, or for its
    memory or time, which only the log of the scheduler's job shows.

    ``scheduler_logs``: Directory of the scheduler's logs of failed jobs; it need not exist.
    ``since``: Seconds since the epoch; logs that were last written before are of other runs.
    """
    failed = [path for path in _written(rule_logs, since) if _DONE not in _end(path, 1)]
    parts = []
    for title, logs in (
        ("did not finish", failed),
        ("log of a job of the scheduler", _written(scheduler_logs, since)),
    ):
        for path in logs[:_MOST_JOBS]:
            end = (_end(path, _LAST_LINES) or "(empty)").replace("\n", "\n    ")
            parts.append(f"{path} ({title}):\n    {end}")
        if len(logs) > _MOST_JOBS:
            others = "".join(f"\n    {path}" for path in logs[_MOST_JOBS:])
            parts.append(f"{len(logs) - _MOST_JOBS} more ({title}):{others}")
    return "\n\n".join(parts)


def _written(directory: Path, since: float) -> list[Path]:
    """Logs that were written since a time, the oldest first."""
    times = {path: path.stat().st_mtime for path in directory.rglob("*.log")}
    return sorted((path for path in times if times[path] >= since), key=lambda path: times[path])


def _end(path: Path, lines: int) -> str:
    """Return the last lines of a file that are not blank."""
    with path.open("rb") as file:
        file.seek(0, 2)
        file.seek(max(0, file.tell() - _LAST_BYTES))
        text = file.read().decode("utf-8", errors="replace")
    return "\n".join([line for line in text.splitlines() if line.strip()][-lines:])
