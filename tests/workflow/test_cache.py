import json
import multiprocessing
import os
import time
from pathlib import Path
from types import SimpleNamespace

import pytest

from burstcast_workflow.fingerprint import fingerprint
from burstcast_workflow.harness import cache
from burstcast_workflow.harness.cache import CachedJob, cached_job, through_cache

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "workflow" / "scripts" / "forecasters" / "train.py"
CODE = fingerprint(SCRIPT, ROOT / "src")


class Files(dict):
    """Named files of a job, as Snakemake hands them over."""


@pytest.fixture
def place(tmp_path):
    (tmp_path / "in.nc").write_bytes(b"input")
    return tmp_path


def job(place: Path, target: str = "a", **changes) -> CachedJob:
    values = {
        "rule": "train",
        "settings": {"seed": 1, "case": "Re400"},
        "script": SCRIPT,
        "code": CODE,
        "inputs": {"ensemble": [place / "in.nc"], "lyapunov": []},
        "outputs": {
            "network": place / target / "network.nc",
            "notes": place / target / "notes.json",
        },
        "identity": {"rule": "train", "seed": 1},
    }
    return CachedJob(**{**values, **changes})


def produce(made: CachedJob, content: str = "result"):
    """Computation of a job's outputs that counts how often it runs."""

    def compute() -> None:
        compute.runs += 1
        for name, path in made.outputs.items():
            path.parent.mkdir(exist_ok=True)
            path.write_text(f"{content} {name}")

    compute.runs = 0
    return compute


def run(place: Path, made: CachedJob, content: str = "result") -> bool:
    """Whether a job's outputs came from the cache; in any case they must be right."""
    compute = produce(made, content)
    hit = through_cache(place / "cache", made, compute)
    assert compute.runs == (0 if hit else 1)
    for name, path in made.outputs.items():
        assert path.read_text() == f"{content} {name}"
    return hit


def entry(place: Path) -> Path:
    (found,) = cache.entries(place / "cache")
    return found.path


def test_the_same_job_elsewhere_is_a_hit(place):
    assert not run(place, job(place))
    assert run(place, job(place, "b"))
    assert run(place, job(place, "a"))  # over outputs that are there


def test_outputs_are_copies(place):
    run(place, job(place))
    run(place, job(place, "b"))
    inodes = {path.stat().st_ino for path in place.rglob("network*")}
    assert len(inodes) == 3
    (place / "b" / "network.nc").write_text("damaged by hand")
    assert run(place, job(place, "c"))


@pytest.mark.parametrize(
    "changes",
    [
        {"rule": "scan"},
        {"identity": {"rule": "train", "seed": 2}},
        {"settings": {"seed": 2, "case": "Re400"}},
        {"settings": {"seed": 1, "case": "Re400", "more": 0}},
        {"inputs": {"ensemble": [], "lyapunov": []}},
    ],
)
def test_whatever_a_job_depends_on_makes_another_entry(place, changes):
    run(place, job(place))
    assert not run(place, job(place, "b", **changes), "another result")


def test_content_of_inputs_counts_and_their_place_does_not(place):
    run(place, job(place))
    (place / "copy.nc").write_bytes(b"input")
    assert run(place, job(place, "b", inputs={"ensemble": [place / "copy.nc"], "lyapunov": []}))
    (place / "in.nc").write_bytes(b"other")  # of the same length
    assert not run(place, job(place, "b"), "another result")


def test_settings_in_another_form_are_the_same(place):
    run(place, job(place))
    assert run(place, job(place, "b", settings={"case": "Re400", "seed": 1.0}))


def test_library_versions_count(place, monkeypatch):
    run(place, job(place))
    monkeypatch.setattr(cache, "_version", lambda library: "99.0")
    assert not run(place, job(place, "b"), "another result")


def test_rules_that_take_seconds_are_not_cached(place):
    assert not run(place, job(place, cached=False))
    assert not run(place, job(place, cached=False))
    assert not (place / "cache").exists()


@pytest.mark.parametrize("damage", ["content", "length", "missing", "record", "no record", "empty"])
def test_damaged_entries_are_not_used_but_made_anew(place, damage):
    run(place, job(place))
    found = entry(place)
    if damage == "content":
        (found / "network").write_text("resulT network")
    elif damage == "length":
        (found / "network").write_text("result")
    elif damage == "missing":
        (found / "notes").unlink()
    elif damage == "record":
        (found / "record.json").write_text('{"files": ')
    elif damage == "no record":
        (found / "record.json").unlink()
    else:
        (found / "record.json").write_text("[]")
    assert not run(place, job(place, "b"))
    assert run(place, job(place, "c"))


def test_a_damaged_entry_replaces_no_output(place):
    run(place, job(place))
    (entry(place) / "notes").write_text("damaged")
    made = job(place, "a")

    def fail() -> None:
        raise RuntimeError("computing failed")

    with pytest.raises(RuntimeError):
        through_cache(place / "cache", made, fail)
    assert made.outputs["network"].read_text() == "result network"
    assert not list(place.rglob("*.partial"))


def test_failed_jobs_leave_nothing(place):
    def fail() -> None:
        raise RuntimeError("computing failed")

    with pytest.raises(RuntimeError):
        through_cache(place / "cache", job(place), fail)
    assert list(cache.entries(place / "cache")) == []


def test_code_that_is_not_what_was_fingerprinted_is_not_cached(place):
    changed = [*CODE[:-1], CODE[-1].split("@")[0] + "@000000000000"]
    assert not run(place, job(place, code=changed))
    assert not run(place, job(place, "b", code=changed))


def test_code_counts(place):
    changed = [*CODE[:-1], CODE[-1].split("@")[0] + "@000000000000"]
    assert cache._key(job(place), {}) != cache._key(job(place, code=changed), {})
    assert cache._key(job(place), {}) == cache._key(job(place, code=CODE[::-1]), {})


def test_inputs_that_change_during_the_job_are_noticed(place):
    made = job(place)

    def compute() -> None:
        produce(made)()
        (place / "in.nc").write_bytes(b"later")

    assert not through_cache(place / "cache", made, compute)
    assert list(cache.entries(place / "cache")) == []


def test_a_cache_that_cannot_be_written_does_not_stop_a_job(place):
    (place / "cache").write_text("a file, no directory")
    assert not run(place, job(place))


def test_large_inputs_are_read_once_as_long_as_they_stay(place, monkeypatch):
    monkeypatch.setattr(cache, "_REMEMBERED_FROM", 0)
    monkeypatch.setattr(cache, "_SETTLED_SECONDS", -1.0)
    monkeypatch.setattr(cache, "_digest", counted := Counted(cache._digest))
    path = place / "in.nc"
    first = cache._remembered_digest(place / "cache", path)
    assert cache._remembered_digest(place / "cache", path) == first
    assert counted.calls == 1
    state = path.stat()
    time.sleep(0.02)
    path.write_bytes(b"INPUT")  # same length, and the time stamp put back
    os.utime(path, ns=(state.st_atime_ns, state.st_mtime_ns))
    assert cache._remembered_digest(place / "cache", path) != first


class Counted:
    def __init__(self, function):
        self.function, self.calls = function, 0

    def __call__(self, *arguments):
        self.calls += 1
        return self.function(*arguments)


def test_a_digest_is_not_remembered_of_a_file_that_has_just_changed(place, monkeypatch):
    monkeypatch.setattr(cache, "_REMEMBERED_FROM", 0)
    cache._remembered_digest(place / "cache", place / "in.nc")
    assert not (place / "cache" / "digests").exists()


def _race(place: Path, number: int) -> None:
    made = job(place, f"run{number}")
    for _ in range(20):
        through_cache(place / "cache", made, produce(made))
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
    for path in place.glob("run*/*"):
        assert path.read_text().startswith("result ")


@pytest.mark.parametrize(
    ("resources", "cached"), [({"cached": 1}, True), ({"cached": 0}, False), ({}, False)]
)
def test_job_from_the_object_of_snakemake(resources, cached):
    snakemake = SimpleNamespace(
        rule="train",
        params=SimpleNamespace(code=["burstcast@1", "train.py@2"]),
        scriptdir="/somewhere",
        input=Files(ensemble="a.nc", lyapunov=["b.json", "c.json"], none=[]),
        output=Files(network="n.nc"),
        resources=resources,
    )
    made = cached_job(snakemake, {"seed": 1}, {"rule": "train", "seed": 1})
    assert made.script == Path("/somewhere/train.py")
    assert made.inputs == {
        "ensemble": [Path("a.nc")],
        "lyapunov": [Path("b.json"), Path("c.json")],
        "none": [],
    }
    assert made.outputs == {"network": Path("n.nc")}
    assert made.identity == {"rule": "train", "seed": 1}
    assert made.cached is cached


# -- command line ----------------------------------------------------------------------------------


@pytest.fixture
def filled(place):
    """Cache of three entries, last used 3, 2 and 1 days ago."""
    for seed in range(3):
        run(place, job(place, settings={"seed": seed}), f"result {seed}")
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
    assert cache.main(["--cache", str(filled), "prune", "--older-than", "36h"]) == 0
    assert left(filled) == {"result 2 network"}
    assert "removed 2 entries" in capsys.readouterr().out


def test_prune_to_a_size_keeps_what_was_used_last(filled):
    sizes = [one.size for one in cache.entries(filled)]
    cache.prune(filled, to_size=sum(sizes) - 1)
    assert left(filled) == {"result 1 network", "result 2 network"}
    cache.prune(filled, to_size=0)
    assert left(filled) == set()


def test_a_hit_counts_as_use(filled, place):
    run(place, job(place, "b", settings={"seed": 0}), "result 0")
    cache.prune(filled, older_than=86400 / 2)
    assert left(filled) == {"result 0 network"}


def test_prune_removes_what_killed_jobs_left(filled):
    old, new = (filled / "building" / name for name in ("old", "new"))
    for directory in (old, new):
        directory.mkdir(parents=True)
    past = time.time() - 3 * 86400
    os.utime(old, (past, past))
    cache.prune(filled)
    assert not old.exists()
    assert new.exists()


def test_verify_removes_damaged_entries(filled, capsys):
    one = next(iter(cache.entries(filled)))
    (one.path / "notes").write_text("damaged")
    assert cache.main(["--cache", str(filled), "verify"]) == 1
    assert "damaged" in capsys.readouterr().out
    assert len(left(filled)) == 2
    assert cache.main(["--cache", str(filled), "verify"]) == 0


def test_size(filled, capsys):
    cache.main(["--cache", str(filled), "size"])
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split()[:2] == ["train", "3"]
    assert lines[-1].split()[:2] == ["all", "3"]


@pytest.mark.parametrize("arguments", [["prune"], ["prune", "--to-size", "5 apples"], []])
def test_bad_arguments(filled, arguments):
    with pytest.raises(SystemExit):
        cache.main(["--cache", str(filled), *arguments])


def test_readable_sizes():
    assert cache.readable_size(0) == "0 B"
    assert cache.readable_size(1536) == "1.5 KiB"
    assert cache.readable_size(3 * 2**40) == "3.0 TiB"
    assert json.dumps(cache._size("1.5G")) == str(1536 * 2**20)
