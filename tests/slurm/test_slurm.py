"""The workflow on a real Slurm, on this machine: make test-slurm.

`profiles/slurm` submits tables of the tiny preset, and two things go wrong on the way: a job of a
case takes more memory than it asked for, for which Slurm kills it, and a job of forecasters is
cancelled while it runs. Both must be submitted again with more memory, and the tables must be those
of a run without Slurm, bit for bit.
"""

import subprocess
import sys
import time
from dataclasses import dataclass, field

import pytest
from helpers_rebuilds import TINY, Project
from one_machine_slurm import Job

pytestmark = pytest.mark.slurm

LONGEST_RUN = 1800  # seconds; ends a run that hangs
TABLES = [f"results/tiny/tables/{name}.csv" for name in ("classification", "control")]
WASTE = """
    import time
    from pathlib import Path

    while not Path("requested").exists():
        time.sleep(0.2)
    waste = b"1" * int(0.95 * 2**20 * int(Path("requested").read_text()))
    time.sleep(5)
    assert waste
"""


@dataclass
class Run:
    """What became of the tables on the cluster."""

    project: Project
    status: int = 0
    jobs: list[Job] = field(default_factory=list)
    cancelled: list[int] = field(default_factory=list)

    def log(self) -> str:
        return (self.project.directory / "snakemake.log").read_text(errors="replace")

    def of_group(self, group: str) -> list[Job]:
        return [job for job in self.jobs if f"rule_{group}" in job.rules]


@pytest.fixture(scope="module")
def run(slurm, tmp_path_factory):
    """Submit, let a job waste memory, cancel the first job of forecasters, wait for the end."""
    project = Project.create(tmp_path_factory.mktemp("cluster") / "project")
    outcome, directory = Run(project), project.directory
    script = directory / "workflow" / "scripts" / "data" / "evaluation_set.py"
    head, end, tail = script.read_text().rpartition('"""\n')  # of the function's docstring
    script.write_text(head + end + WASTE + tail)
    before = len(slurm.jobs())
    options = "--workflow-profile profiles/slurm --slurm-no-account --latency-wait 5"
    # a small machine answers at once: no need to wait as long as a cluster's profile does
    options += " --slurm-init-seconds-before-status-checks 3 --seconds-between-status-checks 2"
    call = [sys.executable, "-m", "snakemake", *TABLES, *options.split(), "--configfile", TINY]
    with (directory / "snakemake.log").open("w") as log:
        running = {"cwd": directory, "env": project.environment(), "stdout": log, "stderr": log}
        process = subprocess.Popen(call, **running)
    deadline, requested = time.monotonic() + LONGEST_RUN, directory / "requested"
    try:
        while process.poll() is None and time.monotonic() < deadline:
            time.sleep(2)
            outcome.jobs = slurm.jobs()[before:]
            for job in outcome.of_group("case"):
                if not requested.exists():
                    requested.write_text(str(job.memory_mib))
            for job in outcome.of_group("forecaster"):
                if not outcome.cancelled and job.state == "RUNNING":
                    slurm.cancel(job)
                    outcome.cancelled.append(job.number)
    finally:
        process.kill()
    outcome.status, outcome.jobs = process.wait(), slurm.jobs()[before:]
    return outcome


def test_campaign_finishes_in_spite_of_two_killed_jobs(run):
    assert run.status == 0, run.log()[-6000:]
    for group in ("case", "forecaster", "tables"):
        assert run.of_group(group)[-1].state == "COMPLETED"


def test_job_that_exceeds_its_memory_is_killed_and_asks_for_twice_as_much(run):
    first, second = run.of_group("case")
    assert first.state in ("FAILED", "OUT_OF_MEMORY", "CANCELLED")
    assert second.memory_mib == 2 * first.memory_mib
    assert second.state == "COMPLETED"
    (log,) = run.project.directory.glob(f"results/slurm-logs/**/{first.number}.log")
    assert "exceeded memory limit" in log.read_text(errors="replace").lower()


def test_cancelled_job_is_submitted_again(run):
    (first,) = [job for job in run.jobs if job.number in run.cancelled]
    again = [job for job in run.of_group("forecaster") if job.memory_mib == 2 * first.memory_mib]
    assert first.state == "CANCELLED"
    assert [job.state for job in again] == ["COMPLETED"]


def test_tables_are_those_of_a_run_on_this_machine_and_nothing_is_left_to_do(run, tmp_path):
    here = Project.create(tmp_path / "project")
    here.made(*TABLES)
    for table in TABLES:
        expected = (here.directory / table).read_text()
        assert (run.project.directory / table).read_text() == expected, table
        assert expected.splitlines()[1:], f"{table} is empty"
    assert run.project.dry_run(*TABLES) == {}
