"""The workflow on a real Slurm, on this machine: make test-slurm.

`profiles/slurm` submits tables of the tiny preset, and two things go wrong on the way: a job of a
case takes more memory than it asked for, for which Slurm kills it, and a job of forecasters is
cancelled while it runs. Both must be submitted again with more memory, and the tables must be those
of a run without Slurm, bit for bit.
"""

import os
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from one_machine_slurm import Job

pytestmark = pytest.mark.slurm

ROOT = Path(__file__).parents[2]
LONGEST_RUN = 1800  # seconds; ends a run that hangs
COPIED = ("Snakefile", "config.yaml", "profiles", "resources", "src", "workflow")
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

    tree: Path
    status: int = 0
    jobs: list[Job] = field(default_factory=list)
    cancelled: list[int] = field(default_factory=list)

    def log(self) -> str:
        return (self.tree / "snakemake.log").read_text(errors="replace")

    def of_group(self, group: str) -> list[Job]:
        return [job for job in self.jobs if f"rule_{group}" in job.rules]


def copy_of_project(directory: Path) -> Path:
    directory.mkdir()
    ignored = shutil.ignore_patterns("__pycache__", "*.egg-info")
    for name in COPIED:
        copy = shutil.copy if (ROOT / name).is_file() else shutil.copytree
        copy(ROOT / name, directory / name, **({} if copy is shutil.copy else {"ignore": ignored}))
    return directory


def snakemake(tree: Path, *arguments: str) -> subprocess.Popen:
    """Start Snakemake with the preset."""
    call = [sys.executable, "-m", "snakemake", *arguments]
    call += ["--configfile", "workflow/presets/tiny.yaml"]
    environment = {**os.environ, "PYTHONPATH": str(tree / "src")}
    log = (tree / "snakemake.log").open("w")
    return subprocess.Popen(call, cwd=tree, env=environment, stdout=log, stderr=log)


@pytest.fixture(scope="module")
def run(slurm, tmp_path_factory):
    """Submit, let a job waste memory, cancel the first job of forecasters, wait for the end."""
    outcome = Run(copy_of_project(tmp_path_factory.mktemp("cluster") / "project"))
    script = outcome.tree / "workflow" / "scripts" / "data" / "evaluation_set.py"
    head, end, tail = script.read_text().rpartition('"""\n')  # of the function's docstring
    script.write_text(head + end + WASTE + tail)
    before = len(slurm.jobs())
    options = "--workflow-profile profiles/slurm --slurm-no-account --latency-wait 5"
    # a small machine answers at once: no need to wait as long as a cluster's profile does
    options += " --slurm-init-seconds-before-status-checks 3 --seconds-between-status-checks 2"
    process = snakemake(outcome.tree, *TABLES, *options.split())
    deadline, requested = time.monotonic() + LONGEST_RUN, outcome.tree / "requested"
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
    for job in outcome.jobs:
        print(f"job {job.number}: {job.state}, {job.memory_mib} MiB, {job.rules}")
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
    (log,) = (run.tree / "results" / "slurm-logs").rglob(f"{first.number}.log")
    assert "exceeded memory limit" in log.read_text(errors="replace").lower()


def test_cancelled_job_is_submitted_again(run):
    (first,) = [job for job in run.jobs if job.number in run.cancelled]
    again = [job for job in run.of_group("forecaster") if job.memory_mib == 2 * first.memory_mib]
    assert first.state == "CANCELLED"
    assert [job.state for job in again] == ["COMPLETED"]


def test_tables_are_those_of_a_run_on_this_machine_and_nothing_is_left_to_do(run, tmp_path):
    tree = copy_of_project(tmp_path / "project")
    assert snakemake(tree, *TABLES, "--cores", "2").wait() == 0
    for table in TABLES:
        assert (run.tree / table).read_bytes() == (tree / table).read_bytes(), table
        assert (tree / table).read_text().splitlines()[1:], f"{table} is empty"
    assert snakemake(run.tree, *TABLES, "--dry-run").wait() == 0
    assert "Nothing to be done" in run.log()
