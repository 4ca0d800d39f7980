"""The run that a results directory belongs to: the newest.

A workflow that is killed leaves jobs behind that still run, or wait in the queue of a cluster, with
the settings of their time. Each run therefore writes a claim, ``.run.json`` in the results
directory, when it starts, and its jobs know its token from an environment variable: a job whose run
is no longer the newest may not write. This holds on shared file systems, too, and needs no lock: a
job that was stopped between the look at the claim and its writing cannot write the record of the
file, too, and a file without its own record is no result (`snaketrust.records`).

The claim also says what was planned: the config, the fingerprints of the code, where the user's own
modules lie, and the revision of the sources, which the records of results repeat. On a cluster,
Snakemake reads the workflow anew for every job, but takes the config from there: edits during a
campaign count at its next run.
"""

import json
import os
import secrets
import socket
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from snaketrust.files import replaced

VARIABLE = "SNAKETRUST_RUN"
"""Environment variable that tells jobs which run they belong to: its token and its results."""

CLAIM = ".run.json"
"""File of the claim, in the results directory."""


class OvertakenError(RuntimeError):
    """Another run has claimed the results directory."""


@dataclass(frozen=True)
class Run:
    """A run of the workflow: a token of its own, and where its results are."""

    token: str
    results: str

    @classmethod
    def new(cls, results: str) -> "Run":
        """Create a run that has not yet claimed its results directory."""
        return cls(secrets.token_hex(8), results)

    @classmethod
    def of_job(cls) -> "Run":
        """Run that the job of this process belongs to."""
        run = cls.current()
        if run is None:
            raise OvertakenError(
                f"the environment variable {VARIABLE} does not reach jobs: let the executor pass "
                f"on the environment"
            )
        return run

    @classmethod
    def current(cls) -> "Run | None":
        """Run that this process belongs to; None outside of the workflow."""
        value = os.environ.get(VARIABLE)
        return cls(*value.split(" ", 1)) if value else None

    def claim(
        self,
        config: Mapping[str, Any],
        code: Mapping[str, str],
        directories: Iterable[str] = (),
        revision: str = "",
        wanted: Iterable[str] = (),
    ) -> None:
        """Claim the results directory for this run, and for the jobs that this process starts.

        ``wanted`` has the names of all files that the run should make if they do not exist.
        """
        self.check_idle()
        host, process = socket.gethostname(), os.getpid()
        claim = {
            "token": self.token,
            "host": host,
            "process": process,
            "started": _started(process),
            "config": config,
            "code": code,
            "directories": list(directories),
            "revision": revision,
            "wanted": list(wanted),
        }
        with replaced(Path(self.results) / CLAIM) as partial:
            partial.write_text(json.dumps(claim, indent=1))
        os.environ[VARIABLE] = f"{self.token} {self.results}"

    def check_idle(self) -> None:
        """Check that no other run of this machine is at work in the results directory."""
        found = self.claimed()
        other = found.get("process", 0)
        here = found.get("host") == socket.gethostname() and other != os.getpid()
        started = found.get("started")  # empty where there is no /proc, and then nothing is known
        if here and started and _started(other) == started:
            raise OvertakenError(
                f"another run, process {other}, is at work in {self.results}: wait for it, or "
                f"choose another directory (results)"
            )

    def plan(self) -> dict[str, Any]:
        """Read the claim of this run; an `OvertakenError` if a newer run has replaced it."""
        claim = self.claimed()
        if claim.get("token") != self.token:
            by = f"{claim.get('host')}, process {claim.get('process')}" if claim else "unknown"
            raise OvertakenError(
                f"{self.results} belongs to a newer run now ({by}): nothing is written for this one"
            )
        return claim

    def claimed(self) -> dict[str, Any]:
        """Claim of the newest run, this one or another; empty if there is none."""
        try:
            found = json.loads((Path(self.results) / CLAIM).read_bytes())
        except (OSError, ValueError, RecursionError):
            return {}
        return found if isinstance(found, dict) else {}


def check_ownership() -> None:
    """Check that the run of this process, if there is one, still has its results directory."""
    if run := Run.current():
        run.plan()


def _started(process: int) -> str:
    """Start of a process, in ticks of the machine's clock; empty if there is no such process."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[19]
    except (OSError, IndexError):
        return ""
