"""The cache of actions: what is taken from it, what is not, and what it does in trouble."""

import ctypes
import os
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from helpers_rebuilds import mounted

from burstcast_workflow.tracking import cache, environment, run
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


def test_a_job_that_a_newer_run_has_overtaken_takes_nothing(tmp_path, monkeypatch):
    computed(tmp_path / "one")
    results = tmp_path / "two"
    results.mkdir()
    (results / run.CLAIM).write_text('{"token": "newer"}')
    monkeypatch.setenv(run.VARIABLE, f"older {results}")
    with pytest.raises(run.OvertakenError, match="belongs to a newer run"):
        taken(results)
    assert [path.name for path in results.iterdir()] == [run.CLAIM]
    monkeypatch.setenv(run.VARIABLE, f"newer {results}")
    assert taken(results) == "12"


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


RECORDS = {
    **{"empty": "", "no JSON": "{", "nested": "[" * 100_000, "a list": "[1, 2]", "null": "null"},
    **{"endless": "NaN", "negative": "-1", "huge": "1" + "0" * 400, "text": '"long"'},
}
"""Damaged records of entries, or seconds in them."""


def record_of(name):
    text = RECORDS[name]
    return (
        text if name in list(RECORDS)[:5] else f'{{"rule": "r", "seconds": {text}, "digests": []}}'
    )


DAMAGES = ["a bit", "cut off", "missing", "no log", "a directory", "a pipe", "a file", *RECORDS]


@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_entry_is_noticed_removed_and_made_again(tmp_path, place, damage, caplog):
    computed(tmp_path / "one")
    blob = blobs(place)[1]
    if damage == "a bit":
        blob.write_text("3")
    elif damage == "cut off":
        os.truncate(tmp_path / "one" / "b.json", 0)  # a result in place, which is a link
    elif damage in RECORDS:
        (blob.parent / "entry.json").write_text(record_of(damage))
    elif damage == "no log":
        (blob.parent / "log").unlink()
    elif damage == "a file":
        shutil.rmtree(blob.parent)
        blob.parent.touch()
    else:
        blob.unlink()
        {"missing": str, "a directory": os.mkdir, "a pipe": os.mkfifo}[damage](blob)
    assert taken(tmp_path / "two") is None
    assert not list((tmp_path / "two").iterdir())
    assert "is damaged" in caplog.text
    assert not list(place.rglob(f"{blob.parent.name}*"))  # nor what it was called for a moment
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
    for name in RECORDS:
        record.write_text(record_of(name))
        assert seconds_of_rules() == {"train": 2.0}
        tidy(10**9)


# -- what is computed whatever the cache has -------------------------------------------------------


@pytest.mark.parametrize("variable", ["1", "yes"])
def test_a_refresh_takes_nothing_and_replaces_what_is_there(tmp_path, place, variable, monkeypatch):
    computed(tmp_path / "one")
    monkeypatch.setenv(cache.REFRESH, variable)
    assert taken(tmp_path / "two") is None
    computed(tmp_path / "two", content="34")
    assert taken(tmp_path / "three") is None
    computed(tmp_path / "two", content="56")
    monkeypatch.delenv(cache.REFRESH)
    assert taken(tmp_path / "three") == "56"
    assert len(list(place.glob("*/*"))) == 1
    for none in ("", "0"):
        monkeypatch.setenv(cache.REFRESH, none)
        assert taken(tmp_path / "four") == "56"


def test_a_refresh_says_where_an_older_entry_stays(tmp_path, place, monkeypatch, caplog):
    computed(tmp_path / "one")
    monkeypatch.setenv(cache.REFRESH, "1")
    monkeypatch.setattr(cache, "_remove", lambda entry: None)  # another user's
    assert taken(tmp_path / "two") is None
    computed(tmp_path / "two", content="34")
    assert "nothing is put into the cache" in caplog.text


def test_every_library_that_files_name_is_in_the_key(monkeypatch):
    """scikit-optimize computes with scikit-learn, which no module of the search imports."""
    before, version = environment.environment(), environment.library_version
    for library in environment.LIBRARIES:
        versions = {library: "another"}
        monkeypatch.setattr(
            environment,
            "library_version",
            lambda name, versions=versions: versions.get(name, version(name)),
        )
        assert environment.environment() != before


# -- other users, and places that are no cache -----------------------------------------------------

JOB = """
import sys
from pathlib import Path
from burstcast_workflow.tracking.cache import Entry, seconds_of_rules, tidy
from burstcast_workflow.tracking.results import digest

outputs = sys.argv[1:]
entry = Entry(outputs, key=1)
assert entry.restore() is None
for path in outputs:
    Path(path).write_text("mine")
entry.store([*map(digest, outputs)], "train", 1.0, Path(outputs[0]))
assert [Path(path).read_text() for path in outputs] == ["mine"] * 2
tidy(0), tidy(0)
seconds_of_rules()
"""


def as_anyone():
    """Take from root, in a process that begins, the power to open what permissions forbid."""
    if os.geteuid() == 0:
        for capability in (1, 2):  # CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH
            ctypes.CDLL(None).prctl(24, capability, 0, 0, 0)  # PR_CAPBSET_DROP


def told_by_a_job(directory):
    """What the cache says on the terminal and in the log while a job computes."""
    directory.mkdir()
    command = [sys.executable, "-c", JOB, *(directory / name for name in ("a.nc", "b.json"))]
    done = subprocess.run(
        command, preexec_fn=as_anyone, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stderr.splitlines()


TAKEN, PUT = "nothing is taken from the cache: ", "nothing is put into the cache: "
NO_CACHE = "there is no cache, since its directory (BURSTCAST_CACHE) cannot be used: "


@pytest.mark.parametrize(
    ("closed", "words"),
    [("prefix", (TAKEN, PUT)), ("entry", (TAKEN,)), ("cache", (TAKEN, PUT, NO_CACHE))],
)
def test_directories_of_another_user_fail_no_job(tmp_path, place, closed, words):
    computed(tmp_path / "one")
    (entry,) = place.glob("*/*")
    where = {"prefix": entry.parent, "entry": entry, "cache": place}[closed]
    where.chmod(0o000)
    lines = told_by_a_job(tmp_path / "two")
    where.chmod(0o700)
    assert len(lines) == len(words)
    assert all(line.startswith(text) for line, text in zip(lines, words, strict=True)), lines
    assert taken(tmp_path / "three") == "12"


def test_a_private_umask_shuts_nobody_out_of_a_shared_cache(tmp_path, place):
    place.mkdir()
    place.chmod(0o2770)
    before = os.umask(0o077)
    try:
        computed(tmp_path / "one")
    finally:
        os.umask(before)
    (prefix,) = place.iterdir()
    assert prefix.stat().st_mode & 0o7777 == 0o2770


@pytest.mark.parametrize(
    ("where", "words"),
    [
        ("/dev/null", NO_CACHE),
        ("/proc/none", NO_CACHE),
        ("file", NO_CACHE),
        ("file/cache", NO_CACHE),
        ("loop", NO_CACHE),
        ("n" * 300, NO_CACHE),
        ("~nobody_of_this_name/cache", "no home directory is known"),
        ("closed", "nothing is put into the cache, which cannot be written: "),
    ],
)
def test_a_place_that_cannot_be_a_cache_is_told_in_one_line(tmp_path, where, words, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").touch()
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "closed").mkdir(0o555)
    monkeypatch.setenv(cache.VARIABLE, where)
    lines = told_by_a_job(tmp_path / "two")
    told = [line for line in lines if not line.startswith((TAKEN, PUT))]
    assert len(told) == 1
    assert words in told[0]
    assert where.removeprefix("~") in told[0]
    left = {"file", "loop", "closed", "two"}
    assert {path.name for path in tmp_path.iterdir()} == left


def test_a_sound_place_is_told_nothing_of(tmp_path, place, monkeypatch):
    assert told_by_a_job(tmp_path / "two") == []
    assert cache.trouble() is None
    monkeypatch.setenv(cache.VARIABLE, "")
    assert cache.trouble() is None
