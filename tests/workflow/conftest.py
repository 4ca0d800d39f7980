"""Campaigns that several modules read, each run once, whatever processes the tests run in."""

import fcntl
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from helpers_configs import miniature_with_other_names
from helpers_rebuilds import TINY, JobServer, Project


@pytest.fixture(scope="session")
def job_server(tmp_path_factory) -> Iterator[JobServer]:
    with JobServer(tmp_path_factory.mktemp("server")).running() as server:
        yield server


def run_once(project: Project, make: Callable[[Project], object]) -> Project:
    """A campaign in a working copy; another process of pytest that wants it, too, waits for it."""
    place = project.directory.parent
    place.mkdir(exist_ok=True)
    with open(place / "lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (place / "made").exists():
            Project.create(project.directory)
            make(project)
            (place / "made").touch()
    return project


@pytest.fixture(scope="session")
def shared(tmp_path_factory, request) -> Path:
    """A directory of all processes of this run of pytest."""
    base = tmp_path_factory.getbasetemp()
    return base.parent if hasattr(request.config, "workerinput") else base


@pytest.fixture(scope="session")
def finished(shared, job_server) -> Project:
    """All forecasters and tables of the tiny preset. Tests change copies of it only."""
    project = Project(shared / "finished/project", job_server, TINY)
    return run_once(project, lambda project: project.made("forecasters", "tables"))


@pytest.fixture(scope="session")
def miniature(shared, job_server) -> Project:
    """The paper's campaign in miniature, all tables, all figures of one case, and the report."""
    project = Project(shared / "miniature/project", job_server, "small.yaml")

    def make(project: Project) -> None:
        config = miniature_with_other_names()
        project.configure(config)
        outcome = project.made("forecasters", "tables", "--verbose")
        # Snakemake looks at what is ready at first and when a job is done, not all the time
        jobs = len([*(project.directory / config["results"] / "logs").rglob("*.log")])
        assert outcome.text.count("Ready jobs:") < 2 * jobs
        figures = sorted(name for name in project.planned() if name.endswith(".png"))
        drawn = [name for name in figures if not name.endswith(OTHERS)]
        assert 15 < len(drawn) < 0.5 * len(figures)
        project.made(*(f"{config['results']}/{name}" for name in drawn))
        outcome = project.snakemake(BURSTCAST_TEST_PRETEND="figure.py")
        assert outcome.status == 0, outcome.text[-3000:]

    return run_once(project, make)


OTHERS = ("_alpha.png", "_Re400.png", "_schematic.png")
"""Ends of the names of figures that are not drawn: of cases other than the example; of no data."""
