"""Kills and damages at random: the next run has the tables of one that nothing disturbed.

A hundred kills and fifty damages are the default; BURSTCAST_KILLS and BURSTCAST_DAMAGES set other
numbers, and BURSTCAST_SEED the seed, which is printed with what was tried.
"""

import os
import random
import shutil
import signal
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest
from helpers_rebuilds import RESULTS, Project, digests
from test_interruption import jobs_of, start

KILLS = int(os.environ.get("BURSTCAST_KILLS", "100"))
DAMAGES = int(os.environ.get("BURSTCAST_DAMAGES", "50"))
SEED = int(os.environ.get("BURSTCAST_SEED", "2026"))

TARGETS = ["lyapunov.json", "events.json", "equations/horizon.nc", "esn-N30-RV-seed0/horizon.nc"]
FILES = [f"{RESULTS}/Re400/{name}" for name in TARGETS]
LONGEST = 20.0  # seconds after which a run is killed; most of it is planning and the first jobs
EDITS = ({}, {"random_seed": 7}, {"case_defaults": {"ensemble": {"series": 50}}})


def bits(project: Project) -> dict[str, str]:
    """Digests of all that was asked for."""
    found = digests(project.results / "Re400")
    return {name: found[name] for name in TARGETS}


def complete(project: Project, overlay: dict) -> dict[str, str]:
    project.snakemake("--unlock", overlay=overlay)
    outcome = project.snakemake(*FILES, overlay=overlay)
    assert outcome.status == 0, outcome.text[-3000:]
    return bits(project)


def end(processes: list[int]) -> None:
    """Wait for orphans, which may still write."""
    for process in processes:
        limit = time.monotonic() + 120
        while Path(f"/proc/{process}").exists():
            if Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] == "Z":
                break
            assert time.monotonic() < limit
            time.sleep(0.1)


@pytest.mark.long
def test_kills_at_random_moments(job_server, tmp_path, capsys):
    sources = Project.create(tmp_path / "sources", job_server)
    undisturbed = []
    for number, edit in enumerate(EDITS):
        project = sources.without_results(tmp_path / f"undisturbed{number}")
        undisturbed.append(complete(project, edit))
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
            assert complete(project, EDITS[after]) == undisturbed[after], (number, victim)
        finally:
            for job in jobs:
                if victim.endswith("stopped") and Path(f"/proc/{job}").exists():
                    os.kill(job, signal.SIGCONT)
        end(jobs)
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
