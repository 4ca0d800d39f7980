import multiprocessing
import os
import shutil
import time

import pytest

from snaketrust import cache
from snaketrust.cache import Cache, restore, store

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


ENVIRONMENT = {"libraries": {"numpy": "2.1"}}


def entry_of(place, environment=ENVIRONMENT, **changes):
    return Cache(place / "cache", environment).entry(**{**JOB, **changes})


def run(place, target="a", content="result", **changes):
    """Whether a job's outputs came from the cache; in any case they must be right."""
    entry = entry_of(place, **changes)
    outputs = {name: place / target / f"{name}.nc" for name in JOB["outputs"]}
    (place / target).mkdir(exist_ok=True)
    hit = restore(entry, outputs)
    if not hit:
        for name, path in outputs.items():
            path.write_text(f"{content} {name}")
        store(entry, "train", outputs, 1.0)
    for name, path in outputs.items():
        assert path.read_text() == f"{content} {name}"
    assert not list((place / target).glob(".*"))
    return hit


def entries(place):
    return sorted((place / "cache" / "entries").glob("*/*"))


def entry(place):
    (found,) = entries(place)
    return found


def test_the_same_job_elsewhere_is_a_hit_in_whatever_order_it_is_described(place):
    assert not run(place)
    assert run(place, "b")
    assert run(place, "a")  # over outputs that are there
    other = {name: dict(reversed(JOB[name].items())) for name in ("identity", "settings", "inputs")}
    assert entry_of(place, **other) == entry_of(place)


def test_what_changes_while_it_is_copied_is_not_kept(place, monkeypatch):
    monkeypatch.setattr(cache, "digest", lambda path: "another")
    assert not run(place)
    assert entries(place) == []
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
        {"environment": {"libraries": {"numpy": "2.2"}}},
    ],
)
def test_whatever_a_job_depends_on_makes_another_entry(place, changes):
    run(place)
    assert not run(place, "b", "another result", **changes)


RECORDS = {
    "half a record": '{"files": ',
    "a list": "[]",
    "files are none": '{"files": 3}',
    "nested without end": '{"files":' * 100_000,
    "nested": '{"files": {"network": {"files": {}}}}',
}
DAMAGES = {
    "content": lambda found: (found / "network").write_text("resulT network"),
    "length": lambda found: (found / "network").write_text("result"),
    "missing": lambda found: (found / "notes").unlink(),
    "a directory": lambda found: [(found / "network").unlink(), (found / "network").mkdir()],
    "no record": lambda found: (found / "record.json").unlink(),
    "a directory for a record": lambda found: [
        (found / "record.json").unlink(),
        (found / "record.json").mkdir(),
    ],
    "a stray file": lambda found: [shutil.rmtree(found), found.write_text("stray")],
    **{
        kind: lambda found, text=text: (found / "record.json").write_text(text)
        for kind, text in RECORDS.items()
    },
}


@pytest.mark.parametrize("kind", DAMAGES)
def test_damaged_entries_are_not_used_but_made_anew(place, kind):
    run(place)
    DAMAGES[kind](entry(place))
    assert not run(place, "b")
    assert run(place, "c")


def test_stray_and_damaged_files_break_nothing(place):
    run(place)
    for name in ("stray", "entries/stray", "entries/ab"):
        (place / "cache" / name).write_text("stray")
    assert run(place)
    run(place)
    (entry(place) / "notes").write_text("damaged")
    outputs = {name: place / "a" / f"{name}.nc" for name in JOB["outputs"]}
    assert not restore(entry_of(place), outputs)
    assert outputs["network"].read_text() == "result network"
    assert not list(place.rglob("*.partial"))


def test_a_damaged_entry_of_a_copied_cache_is_replaced(place):
    """Programs that copy directories may leave out empty ones."""
    run(place)
    (place / "cache" / "building").rmdir()
    (entry(place) / "notes").write_text("damaged")
    assert not run(place, "b")
    assert run(place, "c")


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

    monkeypatch.setattr(cache.os, "rename", forbidden)
    assert not run(place, "b")
    assert (entry(place) / "notes").read_text() == "damaged"


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
    assert not restore(entry_of(place), outputs)
    monkeypatch.setattr(cache, "_copy", plain)
    assert run(place)


def test_a_hit_counts_as_use(place):
    """Entries that nobody has used for a month are found by the times of their directories."""
    run(place)
    past = time.time() - 30 * 86400
    os.utime(entry(place), (past, past))
    run(place, "b")
    assert time.time() - entry(place).stat().st_mtime < 3600


def _race(place, number):
    for _ in range(20):
        run(place, f"run{number}")
        for found in entries(place) if number == 0 else ():
            shutil.rmtree(found, ignore_errors=True)  # somebody prunes


def test_runs_at_once_do_each_other_no_harm(place):
    context = multiprocessing.get_context("fork")
    workers = [context.Process(target=_race, args=(place, number)) for number in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert [worker.exitcode for worker in workers] == [0, 0, 0, 0]
    assert not list((place / "cache" / "building").glob("*"))
