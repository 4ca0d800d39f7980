"""After an interruption the next run completes, with the bits of a run that was not interrupted."""

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path

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


def orphan_of(project: Project, overlay: dict | None = None) -> int:
    """The first job of a workflow that is killed while it runs."""
    workflow, end = start(project, *TARGETS, overlay=overlay), time.monotonic() + 60
    while not list((project.results / "logs").glob("simulate*/*.log")):
        assert time.monotonic() < end, "it never began"
        time.sleep(0.02)
    (orphan,) = jobs_of(workflow)
    workflow.kill()
    workflow.wait()
    return orphan


def test_an_orphan_writes_nothing_once_another_run_has_begun(project, undisturbed):
    orphan = orphan_of(project, {"random_seed": 1, "case_defaults": {"ensemble": {"series": 6000}}})
    os.kill(orphan, signal.SIGSTOP)  # as one that takes long
    assert complete(project, TARGETS, locked=True) == undisturbed
    os.kill(orphan, signal.SIGCONT)
    wait_for_end(orphan)
    assert results(project) == undisturbed
    assert project.dry_run(*TARGETS) == {}


@pytest.mark.long
def test_what_an_orphan_finishes_before_the_next_run_is_kept(project, undisturbed):
    wait_for_end(orphan_of(project))
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


@pytest.mark.long
def test_a_job_runs_out_of_memory(project, tmp_path):
    large = {"case_defaults": {"ensemble": {"series": 3000, "duration": 400}}}
    target = f"{RESULTS}/Re400/dataset.json"
    memory = {"BURSTCAST_TEST_JOB_MEMORY": str(450 * MEGABYTE)}
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


# -- at random: BURSTCAST_KILLS, BURSTCAST_DAMAGES and BURSTCAST_SEED set numbers and seed ---------

KILLS = int(os.environ.get("BURSTCAST_KILLS", "100"))
DAMAGES = int(os.environ.get("BURSTCAST_DAMAGES", "50"))
SEED = int(os.environ.get("BURSTCAST_SEED", "2026"))

AT_RANDOM = ["lyapunov.json", "events.json", "equations/horizon.nc", "esn-N30-RV-seed0/horizon.nc"]
FILES = [f"{RESULTS}/Re400/{name}" for name in AT_RANDOM]
LONGEST = 20.0  # seconds after which a run is killed; most of it is planning and the first jobs
EDITS = ({}, {"random_seed": 7}, {"case_defaults": {"ensemble": {"series": 50}}})


def bits(project: Project) -> dict[str, str]:
    """Digests of all that was asked for."""
    found = digests(project.results / "Re400")
    return {name: found[name] for name in AT_RANDOM}


def completed(project: Project, overlay: dict) -> dict[str, str]:
    project.snakemake("--unlock", overlay=overlay)
    outcome = project.snakemake(*FILES, overlay=overlay)
    assert outcome.status == 0, outcome.text[-3000:]
    return bits(project)


@pytest.mark.long
def test_kills_at_random_moments(job_server, tmp_path, capsys):
    sources = Project.create(tmp_path / "sources", job_server)
    undisturbed = []
    for number, edit in enumerate(EDITS):
        project = sources.without_results(tmp_path / f"undisturbed{number}")
        undisturbed.append(completed(project, edit))
    assert len({tuple(bits.items()) for bits in undisturbed}) == len(EDITS)  # edits change results
    counts: Counter[str] = Counter()
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
        counts[f"{victim}, {'with' if before != after else 'no'} edit, {len(jobs)} jobs"] += 1
    with capsys.disabled():
        print(f"\nseed {SEED}: {KILLS} kills, all with the right bits")
        for what, count in sorted(counts.items()):
            print(f"  {count:3d} {what}")


def damage(path: Path, other: Path, chance: random.Random) -> str:
    """Damage a file in one of several ways; what was done."""
    content, state = path.read_bytes(), path.stat()
    way = chance.choice(
        ["truncated", "emptied", "a bit", "exchanged", "removed", "replaced", "appended"]
    )
    if way == "removed":
        path.unlink()
    elif way == "exchanged":
        temporary = path.with_name("temporary")
        path.rename(temporary)
        other.rename(path)
        temporary.rename(other)
    elif way == "replaced":
        shutil.copy2(other, path)
    else:
        position = chance.randrange(len(content))
        changed = bytearray(content)
        changed[position] ^= 1 << chance.randrange(8)
        new = {
            "truncated": content[:position],
            "emptied": b"",
            "a bit": bytes(changed),
            "appended": content + b"\n",
        }
        path.write_bytes(new[way])
    if path.exists() and chance.random() < 0.7:  # as if nothing had been done
        os.utime(path, ns=(state.st_atime_ns, state.st_mtime_ns))
        way += ", old time"
    return way


@pytest.mark.long
def test_random_damages_are_noticed(finished, tmp_path, capsys):
    project = finished.project.copy(tmp_path / "project")
    undisturbed = digests(project.results)
    names = [
        name
        for name in undisturbed
        if not name.startswith(("logs/", "benchmarks/")) and (project.results / name).stat().st_size
    ]
    counts: Counter[str] = Counter()
    for number in range(DAMAGES):
        chance = random.Random(f"{SEED} damage {number}")
        name = chance.choice(names)
        alike = [one for one in names if Path(one).name == Path(name).name and one != name]
        other = chance.choice(alike or [one for one in names if one != name])
        if chance.random() < 0.2:  # a record instead
            path, another = (project.results / ".records" / f"{one}.json" for one in (name, other))
        else:
            path, another = project.results / name, project.results / other
        way = damage(path, another, chance)
        outcome = project.snakemake("forecasters", "tables")
        assert outcome.status == 0, (number, name, way, outcome.text[-2000:])
        after = digests(project.results)
        if way == "removed" and name not in after:
            # nothing asks for it now, as for an ensemble that made room: whoever does gets it
            assert project.snakemake(f"{RESULTS}/{name}").status == 0, (number, name)
            after, way = digests(project.results), "removed, made again on demand"
        wrong = [one for one in names if after.get(one) != undisturbed[one]]
        assert not wrong, (number, name, way, wrong)
        what = "a record" if ".records" in str(path) else "a result"
        counts[f"{what} {way}"] += 1
    with capsys.disabled():
        print(f"\nseed {SEED}: {DAMAGES} damages, all repaired")
        for what, count in sorted(counts.items()):
            print(f"  {count:3d} {what}")
