"""A group of five jobs of a small workflow on a real Slurm, interrupted in three ways.

Each job says that it ran in ``ran.txt``, and waits as long as a file ``hang<number>`` is there.
"""

import os
import subprocess
import sys
import time

import pytest

from helpers_library import ROOT, said_by

pytestmark = pytest.mark.slurm

SOURCE = ROOT / "src"
PROFILE = ROOT / "profiles" / "slurm"
OPTIONS = (
    f"--workflow-profile {PROFILE} --slurm-no-account --default-resources mem_mb=300 "
    "--slurm-init-seconds-before-status-checks 3 --seconds-between-status-checks 2 --latency-wait 5"
).split()
TRIGGERS = ("--rerun-triggers", "mtime", "params", "input", "software-env")
SNAKEFILE = """
from pathlib import Path
from burstcast_workflow.tracking.code import Sources
from burstcast_workflow.tracking.run import begin

ROOT = Path(str(workflow.current_basedir))
sources = Sources(lambda name: ROOT / "scripts" / name, ROOT / "none", {})
CODE = {"settings": {}, "code": sources.code("step.py", {})}

onstart:
    begin("results", {}, sources.whole(), [], "")

rule all:
    input: "results/total/6.txt"
    localrule: True

rule step:
    input: before=lambda step: [f"results/step/{int(step.n) - 1}.txt"][: int(step.n) - 1]
    output: made="results/step/{n}.txt"
    log: "results/logs/{n}.log"
    wildcard_constraints: n="[1-5]"
    params: **CODE
    group: "five"
    resources: runtime=lambda wildcards: int(int(wildcards.n) > 4)
    script: "scripts/step.py"

rule total:
    input: before="results/step/5.txt"
    output: made="results/total/{n}.txt"
    log: "results/logs/{n}.log"
    params: **CODE
    resources: runtime=1
    script: "scripts/step.py"
"""
SCRIPT = """
import time
from pathlib import Path

from burstcast_workflow.harness.job import JobSettings, job, write_text


@job
def compute(*, before: str | list[str], made: str, settings: JobSettings):
    number = Path(made).stem
    with open("ran.txt", "a") as file:
        file.write(f"{number} ")
    while Path(f"hang{number}").exists():
        time.sleep(0.2)
    paths = [before] if isinstance(before, str) else before
    write_text(made, "".join(Path(path).read_text() for path in paths) + f" {number}")
"""


class Submitted:
    """A workflow whose jobs a Slurm runs."""

    def __init__(self, directory):
        self.directory = directory
        (directory / "scripts").mkdir()
        (directory / "scripts" / "step.py").write_text(SCRIPT)
        (directory / "Snakefile").write_text(SNAKEFILE)

    def run(self, *arguments, fails=False):
        """Run it on this machine, without Slurm; what it said."""
        command = [sys.executable, "-m", "snakemake", "--cores", "1", *TRIGGERS, *arguments]
        return said_by(command, self.directory, int(fails), PYTHONPATH=str(SOURCE))

    def submit(self):
        self.log = self.directory / "snakemake.log"
        with self.log.open("w") as log:
            command = [sys.executable, "-m", "snakemake", *OPTIONS]
            environment = {**os.environ, "PYTHONPATH": str(SOURCE)}
            options = {"cwd": self.directory, "env": environment}
            return subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT, **options)

    def hang(self, number):
        (self.directory / f"hang{number}").touch()

    def go_on(self, number):
        (self.directory / f"hang{number}").unlink()

    def ran(self):
        path = self.directory / "ran.txt"
        return path.read_text().split() if path.exists() else []

    def wait(self, done, seconds=240):
        deadline = time.monotonic() + seconds
        while not done():
            assert time.monotonic() < deadline, (self.ran(), self.log.read_text())
            time.sleep(0.5)

    def finish(self, process):
        """Wait for a run's end, and check its result and that nothing is left to do."""
        self.wait(lambda: process.poll() is not None)
        assert process.returncode == 0, self.log.read_text()
        assert (self.directory / "results/total/6.txt").read_text() == " 1 2 3 4 5 6"
        assert "Nothing to be done" in self.run()


@pytest.fixture
def toy(slurm, tmp_path):
    return Submitted(tmp_path)


@pytest.mark.parametrize("event", ["requeue", "fail_node"])
def test_a_group_that_slurm_starts_again_takes_what_its_members_have_finished_from_the_cache(
    slurm, toy, event
):
    toy.hang(3)
    process = toy.submit()
    toy.wait(lambda: "3" in toy.ran())
    (job,) = slurm.jobs()[-1:]
    getattr(slurm, event)(job)
    toy.wait(lambda: toy.ran().count("3") == 2)
    toy.go_on(3)
    toy.finish(process)
    assert toy.ran() == ["1", "2", "3", "3", "4", "5", "6"]
    assert [entry.number for entry in slurm.jobs() if "five" in entry.rules][-1] == job.number


def test_four_finished_members_of_a_group_are_kept_if_the_last_runs_out_of_time(slurm, toy):
    toy.hang(5)
    process, before = toy.submit(), len(slurm.jobs())
    toy.wait(lambda: "TIMEOUT" in [job.state for job in slurm.jobs()[before:]])
    toy.go_on(5)
    toy.finish(process)
    assert toy.ran() == ["1", "2", "3", "4", "5", "5", "6"]
    first, second, _ = slurm.jobs()[before:]
    assert (first.state, second.state) == ("TIMEOUT", "COMPLETED")


def test_a_run_that_is_started_again_while_a_group_of_the_killed_one_runs_gets_its_results(
    slurm, toy
):
    toy.hang(3)
    process, before = toy.submit(), len(slurm.jobs())
    toy.wait(lambda: "3" in toy.ran())
    process.kill()
    process.wait()
    assert "--unlock" in toy.run(fails=True)
    toy.run("--unlock")
    process = toy.submit()
    toy.wait(lambda: toy.ran().count("3") == 2)
    toy.go_on(3)
    toy.finish(process)
    assert toy.ran() == ["1", "2", "3", "3", "4", "5", "6"]
    old, new, _ = slurm.jobs()[before:]
    assert (old.state, new.state) == ("FAILED", "COMPLETED")
    (log,) = (toy.directory / "results/slurm-logs").rglob(f"{old.number}.log")
    assert "belongs to a newer run" in log.read_text()
