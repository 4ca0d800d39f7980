import multiprocessing
import os
import platform
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from burstcast_workflow import cache_command, command_line
from burstcast_workflow.command_line import main
from burstcast_workflow.harness import cache
from burstcast_workflow.harness.cache import entry_key, restore, store

JOB = {
    "identity": {"rule": "train", "seed": 1},
    "settings": {"seed": 1, "case": "Re400"},
    "code": ["burstcast@1", "train.py@2"],
    "inputs": {"ensemble": ["digest"], "lyapunov": []},
    "outputs": ["network", "notes"],
}


@pytest.fixture
def place(tmp_path):
    return tmp_path


def run(place: Path, target: str = "a", content: str = "result", **changes) -> bool:
    """Whether a job's outputs came from the cache; in any case they must be right."""
    key = entry_key(**{**JOB, **changes})
    outputs = {name: place / target / f"{name}.nc" for name in JOB["outputs"]}
    (place / target).mkdir(exist_ok=True)
    hit = restore(place / "cache", key, outputs)
    if not hit:
        for name, path in outputs.items():
            path.write_text(f"{content} {name}")
        store(place / "cache", key, "train", outputs, 1.0)
    for name, path in outputs.items():
        assert path.read_text() == f"{content} {name}"
    assert not list((place / target).glob(".*"))
    return hit


def entry(place: Path, number: int = -1) -> Path:
    return list(cache.entries(place / "cache"))[number].path


def test_the_same_job_elsewhere_is_a_hit(place):
    assert not run(place)
    assert run(place, "b")
    assert run(place, "a")  # over outputs that are there


def test_what_changes_while_it_is_copied_is_not_kept(place, monkeypatch):
    monkeypatch.setattr(cache, "digest", lambda path: "another")
    assert not run(place)
    assert list(cache.entries(place / "cache")) == []
    assert list((place / "cache" / "building").iterdir()) == []


def test_outputs_are_copies(place):
    run(place)
    run(place, "b")
    inodes = {path.stat().st_ino for path in place.rglob("network*")}
    assert len(inodes) == 3
    (place / "b" / "network.nc").write_text("damaged by hand")
    assert run(place, "c")


@pytest.mark.parametrize(
    "changes",
    [
        {"identity": {"rule": "scan", "seed": 1}},
        {"identity": {"rule": "train", "seed": 2}},
        {"settings": {"seed": 2, "case": "Re400"}},
        {"settings": {"seed": 1, "case": "Re400", "more": 0}},
        {"inputs": {"ensemble": [], "lyapunov": []}},
        {"inputs": {"ensemble": ["another"], "lyapunov": []}},
        {"code": ["burstcast@1", "train.py@3"]},
    ],
)
def test_whatever_a_job_depends_on_makes_another_entry(place, changes):
    run(place)
    assert not run(place, "b", "another result", **changes)


@pytest.mark.parametrize(
    "same", [{"settings": {"case": "Re400", "seed": 1.0}}, {"code": ["train.py@2", "burstcast@1"]}]
)
def test_what_is_written_otherwise_is_the_same(place, same):
    run(place)
    assert run(place, **same)


def test_library_versions_count(place, monkeypatch):
    run(place)
    monkeypatch.setattr(cache, "library_version", lambda library: "99.0")
    assert not run(place, "b", "another result")


@pytest.mark.skipif("openblas" not in "".join(cache.blas_kernels()), reason="no OpenBLAS")
def test_the_kernel_and_the_threads_of_blas_count():
    arm = platform.machine() not in ("x86_64", "AMD64")
    code = f"from burstcast_workflow.harness.cache import *; print(entry_key(**{JOB!r}))"
    threads = {"OPENBLAS_NUM_THREADS": "1"}
    keys = [
        subprocess.run(
            [sys.executable, "-c", code],
            env={**os.environ, **threads, **changes},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for changes in (
            *({}, {}, {"OPENBLAS_NUM_THREADS": "2"}),
            {"OPENBLAS_CORETYPE": "ARMV8" if arm else "Nehalem"},
            {"OPENBLAS_CORETYPE": "CORTEXA57" if arm else "Sandybridge"},
        )
    ]
    assert keys[0] == keys[1]
    assert len(set(keys)) == 4


def damage(found: Path, kind: str) -> None:
    network, record = found / "network", found / "record.json"
    if kind == "content":
        network.write_text("resulT network")
    elif kind == "length":
        network.write_text("result")
    elif kind == "missing":
        (found / "notes").unlink()
    elif kind == "a directory":
        network.unlink()
        network.mkdir()
    elif kind == "no record":
        record.unlink()
    elif kind == "record is a directory":
        record.unlink()
        record.mkdir()
    elif kind == "a stray file":
        shutil.rmtree(found)
        found.write_text("stray")
    else:
        record.write_text(RECORDS[kind])


RECORDS = {
    "half a record": '{"files": ',
    "a list": "[]",
    "files are none": '{"files": 3}',
    "nested without end": '{"files":' * 100_000,
    "nested": '{"files": {"network": {"files": {}}}}',
}
DAMAGES = [
    *("content", "length", "missing", "a directory"),
    *("no record", "record is a directory", "a stray file"),
    *RECORDS,
]


@pytest.mark.parametrize("kind", DAMAGES)
def test_damaged_entries_are_not_used_but_made_anew(place, kind):
    run(place)
    damage(entry(place), kind)
    assert not run(place, "b")
    assert run(place, "c")


@pytest.mark.parametrize("kind", DAMAGES)
def test_verify_finds_and_removes_damaged_entries(place, kind):
    run(place)
    run(place, settings={})
    first = entry(place, 0)
    damage(first, kind)
    assert cache.verify(place / "cache") == [first]
    assert [one.path for one in cache.entries(place / "cache")] != [first]
    assert cache.verify(place / "cache") == []


def test_stray_files_break_nothing(place):
    run(place)
    for name in ("stray", "entries/stray", "entries/ab"):
        (place / "cache" / name).write_text("stray")
    assert run(place)
    assert cache.verify(place / "cache") == []
    assert cache.prune(place / "cache", to_size=10**9) == []


def test_a_damaged_entry_replaces_no_output(place):
    run(place)
    (entry(place) / "notes").write_text("damaged")
    outputs = {name: place / "a" / f"{name}.nc" for name in JOB["outputs"]}
    assert not restore(place / "cache", entry_key(**JOB), outputs)
    assert outputs["network"].read_text() == "result network"
    assert not list(place.rglob("*.partial"))


def test_a_cache_that_cannot_be_written_does_not_stop_a_job(place):
    (place / "cache").write_text("a file, no directory")
    assert not run(place)
    assert not run(place)


def test_a_cache_that_may_only_be_read_is_used(place, monkeypatch):
    """As that of another user is: nobody else may set the times of its files."""
    run(place)

    def forbidden(*arguments, **options):
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(cache.os, "utime", forbidden)
    assert run(place, "b")


def test_a_damaged_entry_that_cannot_be_removed_does_not_stop_a_job(place, monkeypatch):
    run(place)
    (entry(place) / "notes").write_text("damaged")

    def forbidden(*arguments):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(cache, "_remove", forbidden)
    assert not run(place, "b")
    assert cache.verify(place / "cache") == [entry(place)]


def test_an_output_whose_partial_is_removed_says_nothing_about_the_entry(place, monkeypatch):
    """The newer job of a killed workflow's orphan removes what that one has half-written."""
    run(place)
    plain = cache._copy

    def copy(source, target):
        found = plain(source, target)
        target.unlink()
        return found

    monkeypatch.setattr(cache, "_copy", copy)
    outputs = {name: place / "a" / f"{name}.nc" for name in JOB["outputs"]}
    assert not restore(place / "cache", entry_key(**JOB), outputs)
    monkeypatch.setattr(cache, "_copy", plain)
    assert run(place)


def test_the_home_of_nobody_is_no_cache(monkeypatch):
    monkeypatch.setenv(cache.VARIABLE, "~nosuchuser/cache")
    assert cache.location() is None
    assert main(["cache", "size"]) == 2


def _race(place: Path, number: int) -> None:
    for _ in range(20):
        run(place, f"run{number}")
        for found in cache.entries(place / "cache"):
            if number == 0:
                cache._remove(place / "cache", found.path)


def test_runs_at_once_do_each_other_no_harm(place):
    context = multiprocessing.get_context("fork")
    workers = [context.Process(target=_race, args=(place, number)) for number in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert [worker.exitcode for worker in workers] == [0, 0, 0, 0]
    assert cache.verify(place / "cache") == []
    assert not list((place / "cache" / "building").glob("*"))


# -- command line ----------------------------------------------------------------------------------


@pytest.fixture
def filled(place):
    """Cache of three entries, last used 3, 2 and 1 days ago."""
    for seed in range(3):
        run(place, content=f"result {seed}", settings={"seed": seed})
    found = sorted(
        cache.entries(place / "cache"),
        key=lambda entry: (entry.path / "network").read_text(),
    )
    for days, one in zip((3, 2, 1), found, strict=True):
        past = time.time() - days * 86400
        os.utime(one.path / "record.json", (past, past))
    return place / "cache"


def left(directory: Path) -> set[str]:
    return {(one.path / "network").read_text() for one in cache.entries(directory)}


def test_prune_by_age(filled, capsys):
    assert main(["cache", "--cache", str(filled), "prune", "--older-than", "36h"]) == 0
    assert left(filled) == {"result 2 network"}
    assert "removed 2 entries" in capsys.readouterr().out


def test_prune_to_a_size_keeps_what_was_used_last(filled):
    sizes = [one.size for one in cache.entries(filled)]
    cache.prune(filled, to_size=sum(sizes) - 1)
    assert left(filled) == {"result 1 network", "result 2 network"}
    cache.prune(filled, to_size=0)
    assert left(filled) == set()


def test_a_hit_counts_as_use(filled, place):
    run(place, "b", "result 0", settings={"seed": 0})
    cache.prune(filled, older_than=86400 / 2)
    assert left(filled) == {"result 0 network"}


def test_prune_removes_what_killed_jobs_left(filled):
    """And nothing else, whatever directory is named as the cache."""
    old, new = (filled / "building" / f"{digit * 64}.{digit * 12}" for digit in "ab")
    mine = [
        filled / name for name in ("building/house", "entries/ab/mine", "entries/ab/" + 64 * "c")
    ]
    for directory in (old, new, *mine):
        directory.mkdir(parents=True)
        # copying takes an hour, but no day
        age = 3600 if directory == new else 3 * 86400
        os.utime(directory, (time.time() - age, time.time() - age))
    assert main(["cache", "--cache", str(filled), "verify"]) == 0
    cache.prune(filled, to_size=0)
    assert not old.exists()
    assert new.exists()
    assert all(path.exists() for path in mine)


def test_verify_removes_damaged_entries(filled, capsys):
    one = next(iter(cache.entries(filled)))
    (one.path / "notes").write_text("damaged")
    assert main(["cache", "--cache", str(filled), "verify"]) == 1
    assert "damaged" in capsys.readouterr().out
    assert len(left(filled)) == 2
    assert main(["cache", "--cache", str(filled), "verify"]) == 0


def test_size(filled, capsys):
    main(["cache", "--cache", str(filled), "size"])
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split()[:2] == ["train", "3"]
    assert lines[-1].split()[:2] == ["all", "3"]


@pytest.mark.parametrize(
    "arguments", [["prune", "--to-size", "5 apples"], ["prune", "--older-than", "20"], []]
)
def test_bad_arguments(filled, arguments):
    with pytest.raises(SystemExit):
        main(["cache", "--cache", str(filled), *arguments])


def test_pruning_needs_a_limit(filled, capsys):
    assert main(["cache", "--cache", str(filled), "prune"]) == 2
    assert "--older-than or --to-size" in capsys.readouterr().err
    assert len(left(filled)) == 3


def test_readable_sizes():
    assert cache_command.readable_size(0) == "0 B"
    assert cache_command.readable_size(1536) == "1.5 KiB"
    assert cache_command.readable_size(3 * 2**40) == "3.0 TiB"
    assert command_line._size("1.5G") == 1536 * 2**20
