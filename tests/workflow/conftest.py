"""One run of the tiny preset for all tests that look at its results or go on from them."""

from collections.abc import Iterator
from dataclasses import dataclass

import pytest
from helpers_rebuilds import JobServer, Outcome, Project


@dataclass(frozen=True)
class FinishedRun:
    """A working copy in which results have been made. Tests change copies of it only.

    Attributes
    ----------
    project
        The working copy.
    outcome
        How the run ended, and what it said.
    """

    project: Project
    outcome: Outcome


@pytest.fixture(scope="session")
def job_server(tmp_path_factory) -> Iterator[JobServer]:
    with JobServer(tmp_path_factory.mktemp("server")).running() as server:
        yield server


@pytest.fixture(scope="session")
def finished(tmp_path_factory, job_server) -> FinishedRun:
    """All forecasters and tables of the tiny preset."""
    project = Project.create(tmp_path_factory.mktemp("finished") / "project", job_server)
    outcome = project.snakemake("forecasters", "tables")
    assert outcome.status == 0, outcome.text[-3000:]
    return FinishedRun(project, outcome)


@pytest.fixture(scope="session")
def miniature(tmp_path_factory, job_server) -> FinishedRun:
    """The paper's campaign in miniature, whole: all tables and figures."""
    directory = tmp_path_factory.mktemp("miniature") / "project"
    project = Project.create(directory, job_server, "workflow/presets/miniature.yaml")
    outcome = project.snakemake()
    assert outcome.status == 0, outcome.text[-3000:]
    return FinishedRun(project, outcome)
