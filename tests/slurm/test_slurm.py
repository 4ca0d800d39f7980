"""The workflow on a real Slurm, on this machine: make test-slurm.

Slurm's packages are installed if they are missing (Debian, as root), and its daemons are started
on the loopback in a temporary directory (`one_machine_slurm`). The tiny preset is then submitted by
`profiles/slurm`, and two things go wrong on the way: a job of a case takes more memory than it
asked for, for which Slurm kills it, and a job of networks is cancelled while it runs. Both must be
submitted again with more memory, and the tables must be those of a run without Slurm, bit for bit.

Then the figures are submitted, Snakemake is killed while they are being drawn, and the recovery of
docs/cluster.md must bring the run to its end.

It takes four to nine minutes on two cores, depending on what else they do.
"""

import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
import yaml
from helpers_rules import groups, predicted_costs
from one_machine_slurm import Job, OneMachineSlurm, install, installed, reason_not_to_run
from snakemake.utils import update_config

from burstcast_workflow.campaign.campaign import Campaign
from burstcast_workflow.config.loading import load
from burstcast_workflow.costs.model import Cost
from burstcast_workflow.tables.registry import table_names

pytestmark = pytest.mark.slurm

ROOT = Path(__file__).parents[2]
PRESET = "workflow/presets/tiny.yaml"
NODE_MIB = 8000
LONGEST_RUN = 900  # seconds; ends a run that hangs
MARGIN_OF_HOG = 0.95
COPIED = ("Snakefile", "config.yaml", "profiles", "resources", "src", "workflow")


def first_request(group: str) -> int:
    """Memory that the first attempt of a group asks for: that of its largest member, in MiB."""
    project = ["--snakefile", str(ROOT / "Snakefile"), "--directory", str(ROOT)]
    jobs = predicted_costs([*project, "--configfile", str(ROOT / PRESET)])
    members = jobs[jobs["rule"].map(groups()) == group]
    return Cost(0.0, members["predicted_memory_mib"].max()).mib_for(1)


@dataclass
class Run:
    """What became of the campaign on the cluster."""

    tree: Path
    status: int
    log: str
    jobs: list[Job]
    cancelled: list[int] = field(default_factory=list)

    def of_group(self, group: str) -> list[Job]:
        return [job for job in self.jobs if f"rule_{group}" in job.rules]


def copy_of_project(directory: Path) -> Path:
    directory.mkdir()
    for name in COPIED:
        source = ROOT / name
        if source.is_dir():
            ignored = shutil.ignore_patterns("__pycache__", "*.egg-info")
            shutil.copytree(source, directory / name, ignore=ignored)
        else:
            shutil.copy(source, directory / name)
    return directory


def tables(tree: Path) -> list[str]:
    config: dict[str, Any] = {}
    for file in ("config.yaml", PRESET):
        update_config(config, yaml.safe_load((tree / file).read_text()))
    names = table_names(Campaign(load(config)))
    return [f"results/tiny/tables/{name}.csv" for name in names]


def command(tree: Path, *arguments: str) -> tuple[list[str], dict[str, str]]:
    """Call of Snakemake with the preset, and its environment."""
    call = [sys.executable, "-m", "snakemake", *arguments, "--configfile", PRESET]
    environment = {**os.environ, "PYTHONPATH": str(tree / "src"), "PYTHONUNBUFFERED": "1"}
    return call, environment


def here(tree: Path, *arguments: str) -> str:
    """Call Snakemake without Slurm, and return what it says."""
    call, environment = command(tree, *arguments)
    done = subprocess.run(call, cwd=tree, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-6000:]
    return done.stdout + done.stderr


def submit(
    tree: Path, targets: list[str], watch: Callable[[subprocess.Popen], None]
) -> tuple[int, str]:
    """Submit to Slurm, and call ``watch`` every other second; return the status and the log."""
    call, environment = command(
        tree,
        *targets,
        *("--workflow-profile", "profiles/slurm", "--slurm-no-account"),
        # a small machine answers at once: no need to wait as long as a cluster's profile does
        *("--slurm-init-seconds-before-status-checks", "3", "--seconds-between-status-checks", "2"),
        *("--latency-wait", "5"),
    )
    log = tree / "snakemake.log"
    with log.open("w") as stream:
        process = subprocess.Popen(
            call, cwd=tree, env=environment, stdout=stream, stderr=subprocess.STDOUT
        )
        deadline = time.monotonic() + LONGEST_RUN
        try:
            while process.poll() is None and time.monotonic() < deadline:
                time.sleep(2)
                watch(process)
        finally:
            if process.poll() is None:
                process.kill()
            status = process.wait()
    return status, log.read_text(errors="replace")


def let_test_set_waste_memory(tree: Path) -> None:
    """Make one script of the group `case` take more memory than the group's first request."""
    numbers = int(MARGIN_OF_HOG * first_request("case") * 2**20 / 8)
    script = tree / "workflow" / "scripts" / "test_set.py"
    text = script.read_text()
    start = text.index('"""', text.index("def main(")) + 3
    end = text.index('"""', start) + 3
    waste = f"\n    waste = np.ones({numbers})\n    time.sleep(5)\n    assert waste[-1] == 1\n"
    script.write_text("import time\n" + text[:end] + waste + text[end:])


@pytest.fixture(scope="module")
def slurm():
    """A Slurm of one machine, taken down at the end."""
    pytest.importorskip(
        "snakemake_executor_plugin_slurm", reason="needs snakemake-executor-plugin-slurm"
    )
    reason = reason_not_to_run() or (None if installed() else install())
    if reason:
        pytest.skip(reason)
    with tempfile.TemporaryDirectory(prefix="slurm-") as directory:
        one_machine = OneMachineSlurm(Path(directory), cores=2, memory_mib=NODE_MIB)
        try:
            one_machine.start()
            yield one_machine
        finally:
            one_machine.stop()


@pytest.fixture(scope="module")
def run(slurm, tmp_path_factory):
    """Submit the campaign, cancel the first job of networks, wait for the end."""
    tree = copy_of_project(tmp_path_factory.mktemp("cluster") / "project")
    let_test_set_waste_memory(tree)
    cancelled: list[int] = []

    def cancel_one(process: subprocess.Popen) -> None:
        for job in slurm.jobs():
            if not cancelled and "rule_forecaster" in job.rules and job.state == "RUNNING":
                slurm.cancel(job)
                cancelled.append(job.number)

    status, log = submit(tree, tables(tree), cancel_one)
    result = Run(tree, status, log, slurm.jobs(), cancelled)
    for job in result.jobs:
        print(f"job {job.number}: {job.state}, {job.memory_mib} MiB, {job.rules}")
    return result


@pytest.fixture(scope="module")
def recovered(slurm, run):
    """Kill Snakemake while figures are being drawn, and go on as docs/cluster.md says."""

    def kill_when_drawing(process: subprocess.Popen) -> None:
        if any("rule_figures" in job.rules and job.state == "RUNNING" for job in slurm.jobs()):
            time.sleep(5)
            process.kill()

    status, log = submit(run.tree, ["figures"], kill_when_drawing)
    assert status < 0, log[-6000:]
    found = re.search(r"SLURM run ID: (\S+)", log)
    assert found is not None, log[-6000:]
    slurm.cancel_run(found[1])
    here(run.tree, "--unlock")
    before = len(slurm.jobs())
    status, log = submit(run.tree, ["figures"], lambda process: None)
    return Run(run.tree, status, log, slurm.jobs()[before:])


def test_campaign_finishes_in_spite_of_two_killed_jobs(run):
    assert run.status == 0, run.log[-6000:]
    for group in ("case", "forecaster", "tables"):
        assert run.of_group(group)[-1].state == "COMPLETED"


def test_job_that_exceeds_its_memory_is_killed_and_asks_for_twice_as_much(run):
    first, second = run.of_group("case")
    assert first.memory_mib == first_request("case")
    assert first.state in ("FAILED", "OUT_OF_MEMORY", "CANCELLED")
    assert second.memory_mib == 2 * first.memory_mib
    assert second.state == "COMPLETED"


def test_log_of_the_killed_job_is_where_the_profile_says_and_tells_the_reason(run):
    first = run.of_group("case")[0]
    (log,) = (run.tree / "results" / "slurm-logs").rglob(f"{first.number}.log")
    assert "exceeded memory limit" in log.read_text(errors="replace").lower()


def test_cancelled_job_is_submitted_again(run):
    first, second, *_ = run.of_group("network")
    assert [first.number] == run.cancelled
    assert first.state == "CANCELLED"
    assert second.state == "COMPLETED"
    assert second.memory_mib > first.memory_mib


def test_tables_are_those_of_a_run_on_this_machine(run, tmp_path):
    tree = copy_of_project(tmp_path / "project")
    here(tree, *tables(tree), "--cores", "2")
    for table in tables(tree):
        assert (run.tree / table).read_bytes() == (tree / table).read_bytes(), table
        assert io.StringIO((tree / table).read_text()).readlines()[1:], f"{table} is empty"


def test_nothing_is_left_to_do_after_the_run(run):
    assert "Nothing to be done" in here(run.tree, *tables(run.tree), "--dry-run")


def test_figures_are_finished_after_snakemake_was_killed(recovered):
    assert recovered.status == 0, recovered.log[-6000:]
    assert recovered.of_group("figures")[-1].state == "COMPLETED"
    assert "Nothing to be done" in here(recovered.tree, "figures", "--dry-run")
