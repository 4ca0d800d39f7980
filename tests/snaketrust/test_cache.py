import json
import multiprocessing
import os
import shutil
import time
from pathlib import Path

import pytest

from snaketrust import cache
from snaketrust.cache import Cache, restore, store

JOB = {
    "environment": {"libraries": {"numpy": "2.1"}},
    "identity": {"rule": "train", "seed": 1},
    "settings": {"seed": 1, "case": "Re400"},
    "code": ["burstcast@1", "train.py@2"],
    "inputs": {"ensemble": ["digest"], "lyapunov": []},
}


class Place:
    """A directory with a cache in it, and results of jobs."""

    def __init__(self, directory):
        self.directory, self.cache = directory, directory / "cache"

    def entry(self, **changes):
        job = JOB | changes
        return Cache(self.cache, job.pop("environment")).entry(**job)

    def outputs(self, target="a"):
        return {name: self.directory / target / f"{name}.nc" for name in ("network", "notes")}

    def run(self, target="a", content="result", **changes):
        """Whether a job's outputs came from the cache; in any case they must be right."""
        entry, outputs = self.entry(**changes), self.outputs(target)
        (self.directory / target).mkdir(exist_ok=True)
        hit = restore(entry, outputs)
        if not hit:
            for name, path in outputs.items():
                path.write_text(f"{content} {name}")
            store(entry, "train", outputs, 1.0)
        for name, path in outputs.items():
            assert path.read_text() == f"{content} {name}"
        assert not list((self.directory / target).glob(".*"))
        return hit

    def entries(self):
        return sorted((self.cache / "entries").glob("*/*"))


@pytest.fixture
def place(tmp_path):
    return Place(tmp_path)


@pytest.fixture
def entry(place):
    """The entry of a job that has run."""
    assert not place.run()
    (found,) = place.entries()
    assert found == place.entry()
    return found


def forbidden(*arguments, **options):
    raise PermissionError(13, "Permission denied")


def test_store_keeps_copies_which_restore_gives_to_the_same_job_elsewhere(place, entry):
    assert place.run("b")
    assert place.run("a")  # over outputs that are there
    same = {name: dict(reversed(JOB[name].items())) for name in ("identity", "settings", "inputs")}
    assert place.entry(**same) == entry
    inodes = {path.stat().st_ino for path in place.directory.rglob("network*")}
    assert len(inodes) == 3
    (place.directory / "b" / "network.nc").write_text("damaged by hand")
    assert place.run("c")


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
def test_whatever_a_job_depends_on_makes_another_entry(place, entry, changes):
    assert not place.run("b", "another result", **changes)


def replaced_by_a_directory(path):
    path.unlink()
    path.mkdir()


NO_RECORDS = ('{"files": ', "[]", '{"files": 3}', '{"files":' * 100_000)
NO_RECORDS += (json.dumps({"files": {"network": {"files": {}}}}),)
DAMAGES = [
    lambda found: (found / "network").write_text("resulT network"),
    lambda found: (found / "network").write_text("result"),
    lambda found: (found / "notes").unlink(),
    lambda found: replaced_by_a_directory(found / "network"),
    lambda found: (found / "record.json").unlink(),
    lambda found: replaced_by_a_directory(found / "record.json"),
    lambda found: [shutil.rmtree(found), found.write_text("stray")],
    *(lambda found, text=text: (found / "record.json").write_text(text) for text in NO_RECORDS),
]


@pytest.mark.parametrize("copied", [False, True])
@pytest.mark.parametrize("damage", DAMAGES)
def test_damaged_entries_are_not_restored_but_made_anew(place, entry, damage, copied):
    damage(entry)
    if copied:  # programs that copy a cache may leave out empty directories
        (place.cache / "building").rmdir()
    assert not restore(entry, place.outputs())
    assert place.outputs()["network"].read_text() == "result network"
    assert not list(place.directory.rglob("*.partial"))
    assert not place.run("b")
    assert place.run("c")


def test_stray_files_and_what_changes_while_it_is_copied_break_nothing(place, entry, monkeypatch):
    for name in ("stray", "entries/stray", "entries/ab"):
        (place.cache / name).write_text("stray")
    assert place.run()
    monkeypatch.setattr(cache, "digest", lambda path: "another")
    assert not place.run("b", settings={})
    assert [one for one in place.entries() if one.is_dir()] == [entry]
    assert list((place.cache / "building").iterdir()) == []


def test_a_cache_that_may_only_be_read_is_restored_from(place, entry, monkeypatch):
    """As that of another user is: nobody else may set the times of its files, or remove any."""
    monkeypatch.setattr(cache.os, "utime", forbidden)
    assert place.run("b")
    (entry / "notes").write_text("damaged")
    monkeypatch.setattr(cache.os, "rename", forbidden)
    assert not place.run("c")
    assert (entry / "notes").read_text() == "damaged"


def test_a_cache_that_cannot_be_written_does_not_stop_a_job(place):
    place.cache.write_text("a file, no directory")
    assert not place.run()
    assert not place.run()


def test_an_output_whose_partial_is_removed_says_nothing_about_the_entry(place, entry, monkeypatch):
    """The newer job of a killed workflow's orphan removes what that one has half-written."""
    plain = cache._copy
    with monkeypatch.context() as context:
        context.setattr(cache, "_copy", lambda source, to: (plain(source, to), to.unlink())[0])
        assert not restore(entry, place.outputs())
    assert place.run()


def test_a_hit_counts_as_use(place, entry):
    """Entries that nobody has used for a month are found by the times of their directories."""
    past = time.time() - 30 * 86400
    os.utime(entry, (past, past))
    place.run("b")
    assert time.time() - entry.stat().st_mtime < 3600


def _race(directory: Path, number):
    place = Place(directory)
    for _ in range(20):
        place.run(f"run{number}")
        for found in place.entries() if number == 0 else ():
            shutil.rmtree(found, ignore_errors=True)  # somebody prunes


def test_runs_at_once_do_each_other_no_harm(place):
    context = multiprocessing.get_context("fork")
    workers = [context.Process(target=_race, args=(place.directory, n)) for n in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert [worker.exitcode for worker in workers] == [0, 0, 0, 0]
    assert not list((place.cache / "building").glob("*"))
