"""After an interruption the next run completes, with the bits of a run that was not interrupted."""

import os
import signal
import subprocess
import sys
import time

import pytest
from helpers_rebuilds import RESULTS, Project, digests

# the three jobs up to these files take seconds, in processes of their own as users run them
TARGETS = [f"{RESULTS}/Re400/{name}" for name in ("lyapunov.json", "events.json")]
MEGABYTE = 2**20


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """Run that nothing interrupts: what it wrote."""
    return complete(Project.create(tmp_path_factory.mktemp("undisturbed") / "project"), TARGETS)


@pytest.fixture
def project(tmp_path):
    return Project.create(tmp_path / "project")


def results(project: Project) -> dict[str, str]:
    """Digests of all results but logs and benchmarks, which have times in them."""
    return {
        name: digest
        for name, digest in digests(project.results).items()
        if name.split("/")[0] not in ("logs", "benchmarks")
    }


def start(project: Project, *arguments: str, overlay: dict | None = None) -> subprocess.Popen:
    return subprocess.Popen(
        [sys.executable, "-m", "snakemake", *project.options(*arguments, overlay=overlay)],
        cwd=project.directory,
        env=project.environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )


def wait_for_log(project: Project, rule: str, seconds: float = 60) -> None:
    end = time.monotonic() + seconds
    while not list((project.results / "logs").glob(f"{rule}*/*.log")):
        assert time.monotonic() < end, f"{rule} never began"
        time.sleep(0.02)


def jobs_of(workflow: subprocess.Popen) -> list[int]:
    """Process numbers of the scripts that a workflow runs."""
    found = subprocess.run(
        ["pgrep", "-s", str(workflow.pid), "-f", r"python[^ ]* .*\.snakemake/scripts/tmp"],
        capture_output=True,
        text=True,
        check=False,
    )
    return [int(number) for number in found.stdout.split()]


def complete(project: Project, targets: list[str], *, locked: bool = False) -> dict[str, str]:
    """What a user does, at first and after an interruption: what is there in the end."""
    if locked:
        project.snakemake("--unlock")
    outcome = project.snakemake(*targets)
    assert outcome.status == 0, outcome.text[-3000:]
    assert not list(project.results.rglob("*.partial"))
    return results(project)


def test_the_workflow_is_killed(project, undisturbed):
    workflow = start(project, *TARGETS)
    wait_for_log(project, "lyapunov")
    workflow.kill()  # its jobs run on
    workflow.wait()
    assert complete(project, TARGETS, locked=True) == undisturbed


def test_an_orphan_writes_nothing_once_another_run_has_begun(project, undisturbed):
    larger = {"random_seed": 1, "case_defaults": {"ensemble": {"series": 6000}}}
    workflow = start(project, *TARGETS, overlay=larger)
    wait_for_log(project, "simulate")
    (orphan,) = jobs_of(workflow)
    workflow.kill()
    workflow.wait()
    os.kill(orphan, signal.SIGSTOP)  # as one that takes long
    assert complete(project, TARGETS, locked=True) == undisturbed
    os.kill(orphan, signal.SIGCONT)
    wait_for_end(orphan)
    assert results(project) == undisturbed
    assert project.dry_run(*TARGETS) == {}


@pytest.mark.long
def test_what_an_orphan_finishes_before_the_next_run_is_kept(project, undisturbed):
    workflow = start(project, *TARGETS)
    wait_for_log(project, "simulate")
    (orphan,) = jobs_of(workflow)
    workflow.kill()
    workflow.wait()
    wait_for_end(orphan)
    project.snakemake("--unlock")
    assert project.dry_run(*TARGETS) == {"lyapunov": 1, "events": 1}
    assert complete(project, TARGETS) == undisturbed


def wait_for_end(process: int, seconds: float = 120) -> None:
    end = time.monotonic() + seconds
    while os.path.exists(f"/proc/{process}") and _state(process) != "Z":
        assert time.monotonic() < end, f"process {process} does not end"
        time.sleep(0.1)


def _state(process: int) -> str:
    with open(f"/proc/{process}/stat") as file:
        return file.read().rpartition(")")[2].split()[0]


def test_a_second_run_waits_until_the_first_is_over(project):
    workflow = start(project, *TARGETS)
    wait_for_log(project, "simulate")
    outcome = project.snakemake("--nolock", f"{RESULTS}/Re400/statistics_data.nc")
    assert outcome.status == 1
    said = f"another run, process {workflow.pid}, is at work in {RESULTS}: wait for it"
    assert said in outcome.text
    assert workflow.wait() == 0


def test_a_job_is_killed(project, undisturbed):
    workflow = start(project, *TARGETS)
    wait_for_log(project, "lyapunov")
    for job in jobs_of(workflow):
        os.kill(job, signal.SIGKILL)
    assert workflow.wait() != 0
    assert complete(project, TARGETS) == undisturbed


@pytest.mark.long
def test_a_job_runs_out_of_memory(project, tmp_path):
    large = {"case_defaults": {"ensemble": {"series": 3000, "duration": 400}}}
    target = f"{RESULTS}/Re400/dataset.json"
    memory = {"BURSTCAST_TEST_JOB_MEMORY": str(300 * MEGABYTE)}
    assert project.snakemake(target, overlay=large, **memory).status != 0
    assert "MemoryError" in (project.results / "logs" / "simulate" / "Re400.log").read_text()
    assert results(project) == {}
    other = Project.create(tmp_path / "undisturbed")
    for each in (project, other):
        assert each.snakemake(target, overlay=large).status == 0
    assert results(project) == results(other)


def test_the_disk_is_full(project, undisturbed):
    disk = project.directory / "results"
    disk.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=1m", "none", disk], capture_output=True, check=False
    )
    if mounted.returncode != 0:
        pytest.skip("a disk of a given size needs the right to mount one")
    try:
        outcome = project.snakemake(*TARGETS)
        assert outcome.status != 0
        assert not (project.results / "Re400" / "ensemble.nc").exists()
        assert "the disk is full: make room, and run again" in outcome.text
        subprocess.run(["mount", "-o", "remount,size=64m", disk], check=True)
        assert complete(project, TARGETS) == undisturbed
    finally:
        subprocess.run(["umount", "-l", disk], check=True)


LONG_TARGETS = [
    *TARGETS,
    *(f"{RESULTS}/Re400/esn-N30-RV-seed0/{name}" for name in ("horizon.nc", "forecast.nc")),
]


@pytest.fixture(scope="module")
def longer(tmp_path_factory):
    """Run of more jobs that nothing interrupts."""
    return complete(Project.create(tmp_path_factory.mktemp("longer") / "project"), LONG_TARGETS)


@pytest.mark.long
@pytest.mark.parametrize("victim", ["workflow", "jobs", "everything"])
@pytest.mark.parametrize("moment", [2, 3, 4, 5, 6, 8, 10, 13])
def test_killed_at_any_moment(project, longer, victim, moment):
    workflow = start(project, *LONG_TARGETS)
    time.sleep(moment)
    if victim in ("jobs", "everything"):
        for job in jobs_of(workflow):
            os.kill(job, signal.SIGKILL)
    if victim in ("workflow", "everything"):
        workflow.kill()
    workflow.wait()
    assert complete(project, LONG_TARGETS, locked=True) == longer
