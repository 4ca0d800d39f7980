"""The cache of actions: what is taken from it, what is not, and what it does in trouble."""

import os
import shutil
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from helpers_rebuilds import mounted

from burstcast_workflow.tracking import cache
from burstcast_workflow.tracking.cache import Entry, seconds_of_rules, tidy
from burstcast_workflow.tracking.results import digest


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch):
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path / "cache"))
    return tmp_path / "cache"


def computed(directory, content="12", key=1, rule="train", seconds=2.0):
    """Outputs of a job, which are put into the cache."""
    directory.mkdir(exist_ok=True)
    outputs = [str(directory / name) for name in ("a.nc", "b.json")]
    for path, text in zip(outputs, content, strict=True):
        Path(path).unlink(missing_ok=True)
        Path(path).write_text(text)
    log = directory / "job.log"
    log.write_text("a warning")
    Entry(outputs, key=key).store(list(map(digest, outputs)), rule, seconds, log)
    return outputs


def taken(directory, key=1):
    """Contents of the outputs that are taken from the cache; None if there are none."""
    directory.mkdir(exist_ok=True)
    outputs = [str(directory / name) for name in ("a.nc", "b.json")]
    made = Entry(outputs, key=key).restore()
    assert not list(directory.glob(".*.partial"))
    return made and "".join(Path(path).read_text() for path in outputs)


def blobs(place):
    entries = sorted(place.glob("*/*"))
    return [entry / name for entry in entries for name in "01" if (entry / name).is_file()]


def test_a_job_takes_outputs_log_and_seconds_of_one_with_the_same_key(tmp_path):
    outputs = computed(tmp_path / "one", key={"x": 1, "y": [2]})
    made = Entry([path.replace("one", "two") for path in outputs], key={"y": [2], "x": 1})
    (tmp_path / "two").mkdir()
    assert made.restore() == (2.0, "a warning")
    assert taken(tmp_path / "two", key={"x": 1, "y": [2]}) == "12"
    assert taken(tmp_path / "three", key={"x": 1, "y": [3]}) is None


def test_results_are_links_which_cost_nothing_and_share_no_time(tmp_path, place):
    first = computed(tmp_path / "one")
    assert all(os.stat(path).st_nlink == 2 for path in first)
    before = [os.stat(path).st_mtime_ns for path in first]
    # held by the first campaign: the second one has copies, and its times are its own
    assert taken(tmp_path / "two") == "12"
    assert all(os.stat(path).st_nlink == 2 for path in first)
    assert [os.stat(path).st_mtime_ns for path in first] == before
    # held by nobody: the third one has the links, dated now
    for path in first:
        os.unlink(path)
    begin = time.time_ns() - 10**9
    assert taken(tmp_path / "three") == "12"
    states = [os.stat(tmp_path / "three" / name) for name in ("a.nc", "b.json")]
    assert all(state.st_nlink == 2 and state.st_mtime_ns > begin for state in states)


@pytest.mark.parametrize("damage", ["a bit", "cut off", "missing", "record", "no log"])
def test_a_damaged_entry_is_noticed_removed_and_made_again(tmp_path, place, damage, caplog):
    computed(tmp_path / "one")
    blob = blobs(place)[1]
    if damage == "a bit":
        blob.write_text("3")
    elif damage == "cut off":
        os.truncate(tmp_path / "one" / "b.json", 0)  # a result in place, which is a link
    elif damage == "missing":
        blob.unlink()
    elif damage == "record":
        (blob.parent / "entry.json").write_text("{")
    else:
        (blob.parent / "log").unlink()
    assert taken(tmp_path / "two") is None
    assert not list((tmp_path / "two").iterdir())
    assert "is damaged" in caplog.text
    assert not blob.parent.exists()
    computed(tmp_path / "one")
    assert taken(tmp_path / "two") == "12"


def test_readers_and_writers_of_a_damaged_entry_never_take_it(tmp_path, place):
    def work(number):
        if number % 3 == 0:
            for blob in blobs(place):
                if number % 2:
                    blob.unlink(missing_ok=True)
        elif number % 3 == 1:
            computed(tmp_path / f"writer{number}")
        return taken(tmp_path / f"reader{number}")

    computed(tmp_path / "one")
    with ThreadPoolExecutor(8) as pool:
        assert set(pool.map(work, range(60))) <= {"12", None}
    computed(tmp_path / "one")
    assert len(list(place.glob("*/*"))) == 1


def test_no_cache_no_entry(tmp_path, monkeypatch, place):
    monkeypatch.setenv(cache.VARIABLE, "")
    computed(tmp_path / "one")
    assert taken(tmp_path / "two") is None
    assert not place.exists()
    assert cache.directory() is None
    tidy(0)
    assert seconds_of_rules() == {}
    monkeypatch.delenv(cache.VARIABLE)
    monkeypatch.chdir(tmp_path)
    assert cache.directory() == tmp_path / ".burstcast_cache"


def test_where_no_links_are_possible_there_are_copies(tmp_path, place, monkeypatch):
    def refuse(*_):
        raise OSError(18, "Invalid cross-device link")

    monkeypatch.setattr(os, "link", refuse)
    outputs = computed(tmp_path / "one")
    assert all(os.stat(path).st_nlink == 1 for path in outputs)
    assert taken(tmp_path / "two") == "12"


def test_on_another_file_system_which_is_full_nothing_is_kept_and_nothing_fails(
    tmp_path, place, caplog
):
    with mounted(place, "64k"):
        computed(tmp_path / "one")
        assert taken(tmp_path / "two") == "12"
        computed(tmp_path / "large", content=["x" * 100_000, "y"], key=2)
        assert "nothing is put into the cache" in caplog.text
        assert taken(tmp_path / "three", key=2) is None
        assert taken(tmp_path / "three") == "12"


def test_a_full_disk_of_results_leaves_no_half_of_a_result(tmp_path, caplog):
    computed(tmp_path / "one", content=["x" * 100_000, "y"])
    with mounted(tmp_path / "two", "64k"):
        assert taken(tmp_path / "two") is None
        assert "nothing is taken from the cache" in caplog.text
        assert not list((tmp_path / "two").iterdir())


def test_a_cache_that_cannot_be_written_is_read(tmp_path, place):
    computed(tmp_path / "one")
    with mounted(tmp_path / "other", "1m"):
        shutil.copytree(place, tmp_path / "other" / "cache")
        subprocess.run(["mount", "-o", "remount,ro", tmp_path / "other"], check=True)
        os.environ[cache.VARIABLE] = str(tmp_path / "other" / "cache")
        assert taken(tmp_path / "two") == "12"
        computed(tmp_path / "three", key=3)
        assert taken(tmp_path / "four", key=3) is None


def test_what_was_unused_for_longest_goes_and_what_results_link_to_costs_nothing(tmp_path, place):
    for key in range(4):
        for path in computed(tmp_path / str(key), content=["x" * 1000, "y"], key=key):
            if key != 0:
                os.unlink(path)  # superseded
    for age, record in enumerate(sorted(place.rglob("entry.json"), key=os.path.getmtime)):
        os.utime(record, (time.time() - 100 + age,) * 2)
    assert taken(tmp_path / "again", key=1)  # used last
    for path in (tmp_path / "again").iterdir():
        path.unlink()
    tidy(4000)
    assert [bool(taken(tmp_path / "look", key=key)) for key in range(4)] == [True] * 4
    shutil.rmtree(tmp_path / "look")
    for age, key in enumerate((2, 3, 1, 0)):
        record = Entry([], key=key)._place / "entry.json"
        os.utime(record, (time.time() - 100 + age,) * 2)
    tidy(1500)
    left = [(Entry([], key=key)._place).exists() for key in range(4)]
    assert left == [True, True, False, False]
    tidy(0)
    assert [(Entry([], key=key)._place).exists() for key in range(4)] == [True, False, False, False]


def test_leftovers_of_killed_writers_go_after_a_day_and_files_of_others_stay(tmp_path, place):
    computed(tmp_path / "one")
    entry = next(place.glob("*/*"))
    old, new = (entry.with_name(f"{entry.name}.{end}") for end in ("0123abcd", "89abcdef"))
    for path in (old, new, place / "aa" / "notes"):
        path.mkdir(parents=True)
    os.utime(old, (time.time() - 2 * 86400,) * 2)
    tidy(0)
    assert not old.exists()
    assert new.exists()
    assert (place / "aa" / "notes").exists()
    assert entry.exists()


def test_seconds_of_rules_are_medians_and_damaged_entries_do_not_count(tmp_path, place):
    for key, seconds in enumerate((1.0, 5.0, 2.0)):
        computed(tmp_path / "one", key=key, seconds=seconds)
    computed(tmp_path / "one", key=9, rule="scan", seconds=7.5)
    record = Entry([], key=9)._place / "entry.json"
    assert seconds_of_rules() == {"train": 2.0, "scan": 7.5}
    record.write_text("[]")
    assert seconds_of_rules() == {"train": 2.0}
