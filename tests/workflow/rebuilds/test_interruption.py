"""After an interruption the next run completes, with the bits of a run that was not interrupted."""

import os
import random
import signal
import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import pytest
from helpers_rebuilds import RESULTS, Project, digests, mounted

# the three jobs up to these files take seconds, in processes of their own as users run them
TARGETS = [f"{RESULTS}/Re400/{name}" for name in ("lyapunov.json", "events.json")]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """Run that nothing interrupts, on one core: what it wrote."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("BURSTCAST_TEST_CORES", "1")
        project = Project.create(tmp_path_factory.mktemp("undisturbed") / "project")
        return complete(project, TARGETS)


@pytest.fixture
def project(tmp_path):
    return Project.create(tmp_path / "project")


def start(project: Project, *arguments: str, overlay: dict | None = None) -> subprocess.Popen:
    return subprocess.Popen(
        [sys.executable, "-m", "snakemake", *project.options(*arguments, overlay=overlay)],
        cwd=project.directory,
        env=project.environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )


def jobs_of(workflow: subprocess.Popen) -> list[int]:
    """Process numbers of the scripts that a workflow runs."""
    processes = subprocess.run(
        ["pgrep", "-s", str(workflow.pid), "-f", r"python[^ ]* .*\.snakemake/scripts/tmp"],
        capture_output=True,
        text=True,
        check=False,
    )
    return [int(number) for number in processes.stdout.split()]


def complete(project: Project, targets: list[str], *, locked: bool = False) -> dict[str, str]:
    """What a user does, at first and after an interruption: what is there in the end."""
    if locked:
        project.snakemake("--unlock")
    outcome = project.snakemake(*targets)
    assert outcome.status == 0, outcome.text[-3000:]
    assert not list(project.results.rglob("*.partial"))
    return project.bits()


def orphan_of(project: Project, overlay: dict | None = None) -> int:
    """The first job of a workflow that is killed while it runs."""
    workflow, end = start(project, *TARGETS, overlay=overlay), time.monotonic() + 300
    while not list((project.results / "logs").glob("simulate*/*.log")):
        assert time.monotonic() < end, "it never began"
        time.sleep(0.02)
    while len(jobs := jobs_of(workflow)) != 1:  # one that writes the unit of time has begun, too
        assert time.monotonic() < end, "others do not end"
        time.sleep(0.02)
    (orphan,) = jobs
    workflow.kill()
    workflow.wait()
    return orphan


def test_jobs_one_by_one_in_processes_of_their_own_have_the_bits_of_those_of_the_server(
    undisturbed, finished
):
    assert len(undisturbed) > 3
    together = finished.bits()
    assert undisturbed == {name: together[name] for name in undisturbed}


def test_an_orphan_writes_nothing_once_another_run_has_begun(project, job_server, undisturbed):
    orphan = orphan_of(project, {"random_seed": 1, "case_defaults": {"ensemble": {"series": 6000}}})
    os.kill(orphan, signal.SIGSTOP)  # as one that takes long
    project = replace(project, server=job_server)
    assert complete(project, TARGETS, locked=True) == undisturbed
    os.kill(orphan, signal.SIGCONT)
    wait_for_end(orphan)
    assert project.bits() == undisturbed
    assert project.dry_run(*TARGETS) == {}


def wait_for_end(process: int, seconds: float = 300) -> None:
    end = time.monotonic() + seconds
    while os.path.exists(f"/proc/{process}") and _state(process) != "Z":
        assert time.monotonic() < end, f"process {process} does not end"
        time.sleep(0.1)


def _state(process: int) -> str:
    with open(f"/proc/{process}/stat") as file:
        return file.read().rpartition(")")[2].split()[0]


def test_the_disk_is_full(project, job_server, undisturbed):
    project = replace(project, server=job_server)
    with mounted(disk := project.directory / "results", "1m"):
        outcome = project.snakemake(*TARGETS)
        assert outcome.status != 0
        assert not (project.results / "Re400" / "ensemble.nc").exists()
        assert "the disk is full: make room, and run again" in outcome.text
        subprocess.run(["mount", "-o", "remount,size=64m", disk], check=True)
        assert complete(project, TARGETS) == undisturbed


# -- at random: BURSTCAST_KILLS and BURSTCAST_SEED set number and seed -----------------------------

KILLS = int(os.environ.get("BURSTCAST_KILLS", "20"))
SEED = int(os.environ.get("BURSTCAST_SEED", "2026"))

AT_RANDOM = [
    *("lyapunov.json", "events.json"),
    *("models/equations/horizon.nc", "networks/esn-N30-RV-seed0/horizon.nc"),
]
FILES = [f"{RESULTS}/Re400/{name}" for name in AT_RANDOM]
LONGEST = 20.0  # seconds after which a run is killed; most of it is planning and the first jobs
EDITS = ({}, {"random_seed": 7}, {"case_defaults": {"ensemble": {"series": 50}}})


def bits(project: Project) -> dict[str, str]:
    """Digests of all that was asked for."""
    made = digests(project.results / "Re400")
    return {name: made[name] for name in AT_RANDOM}


def completed(project: Project, overlay: dict) -> dict[str, str]:
    project.snakemake("--unlock", overlay=overlay)
    outcome = project.snakemake(*FILES, overlay=overlay)
    assert outcome.status == 0, outcome.text[-3000:]
    return bits(project)


@pytest.mark.long
def test_kills_at_random_moments(job_server, tmp_path):
    sources = Project.create(tmp_path / "sources", job_server)
    undisturbed = []
    for number, edit in enumerate(EDITS):
        project = sources.without_results(tmp_path / f"undisturbed{number}")
        undisturbed.append(completed(project, edit))
    assert len({tuple(bits.items()) for bits in undisturbed}) == len(EDITS)  # edits change results
    for number in range(KILLS):
        chance = random.Random(f"{SEED} kill {number}")
        project = sources.without_results(tmp_path / "project")
        before, after = chance.randrange(len(EDITS)), chance.randrange(len(EDITS))
        victim = chance.choice(["workflow", "jobs", "everything", "workflow, jobs stopped"])
        # in processes of its own, as users run it
        workflow = start(replace(project, server=None), *FILES, overlay=EDITS[before])
        time.sleep(chance.uniform(0.5, LONGEST))
        jobs = jobs_of(workflow)
        for job in jobs:
            with suppress(ProcessLookupError):  # it may have ended since
                if victim in ("jobs", "everything"):
                    os.kill(job, signal.SIGKILL)
                elif victim.endswith("stopped"):
                    os.kill(job, signal.SIGSTOP)  # as orphans that take long
        if victim != "jobs":
            workflow.kill()
        workflow.wait()
        try:
            assert completed(project, EDITS[after]) == undisturbed[after], (number, victim)
        finally:
            for job in jobs:
                if victim.endswith("stopped") and Path(f"/proc/{job}").exists():
                    os.kill(job, signal.SIGCONT)
        for job in jobs:  # they may still write
            wait_for_end(job)
        assert bits(project) == undisturbed[after], (number, victim, "an orphan wrote")
        assert project.dry_run(*FILES, overlay=EDITS[after]) == {}
