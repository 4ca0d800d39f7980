"""Campaigns that several modules read, each run once, whatever processes the tests run in."""

import fcntl
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from helpers_rebuilds import TINY, JobServer, Outcome, Project


@dataclass(frozen=True)
class FinishedRun:
    """A working copy in which results have been made. Tests change copies of it only."""

    project: Project
    outcome: Outcome


@pytest.fixture(scope="session")
def job_server(tmp_path_factory) -> Iterator[JobServer]:
    with JobServer(tmp_path_factory.mktemp("server")).running() as server:
        yield server


def run_once(place: Path, server: JobServer, preset: str, *targets: str) -> FinishedRun:
    """A campaign below a directory; another process of pytest that wants it, too, waits for it."""
    directory, said = place / "project", place / "said.txt"
    place.mkdir(exist_ok=True)
    with open(place / "lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not said.exists():
            project = Project.create(directory, server, preset)
            outcome = project.made(*targets)
            said.write_text(outcome.text)
    return FinishedRun(Project(directory, server, preset), Outcome(0, said.read_text()))


@pytest.fixture(scope="session")
def shared(tmp_path_factory, request) -> Path:
    """A directory of all processes of this run of pytest."""
    own = tmp_path_factory.getbasetemp()
    return own.parent if hasattr(request.config, "workerinput") else own


@pytest.fixture(scope="session")
def finished(shared, job_server) -> FinishedRun:
    """All forecasters and tables of the tiny preset."""
    return run_once(shared / "finished", job_server, TINY, "forecasters", "tables")


@pytest.fixture(scope="session")
def miniature(shared, job_server) -> FinishedRun:
    """The paper's campaign in miniature, whole: all tables and figures."""
    return run_once(shared / "miniature", job_server, "workflow/presets/miniature.yaml")
