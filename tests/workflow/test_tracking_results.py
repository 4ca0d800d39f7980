"""Digests beside results: a result that is not what its job wrote is noticed."""

import os
import shutil

import pytest

from burstcast_workflow.tracking.results import (
    DamagedResultError,
    checked,
    damaged,
    date_after,
    digest,
    note,
)


@pytest.fixture
def result(tmp_path):
    path = tmp_path / "Re400" / "events.nc"
    path.parent.mkdir()
    path.write_text("events")
    note(path, digest(path))
    return path


def keeping_time(path, change):
    state = path.stat()
    change(path)
    os.utime(path, ns=(state.st_atime_ns, state.st_mtime_ns))


def exchange(path):
    other = path.with_name("other.nc")
    other.write_text("EVENTS")
    os.replace(other, path)


@pytest.mark.parametrize(
    "change",
    [
        lambda path: path.write_text("Events"),
        lambda path: os.truncate(path, 2),
        lambda path: path.write_bytes(b""),
        lambda path: keeping_time(path, lambda path: os.truncate(path, 2)),  # the size tells
        lambda path: keeping_time(path, exchange),  # the inode tells
    ],
    ids=["edited", "cut off", "emptied", "cut off, old time", "exchanged, old time"],
)
def test_a_result_that_was_changed_stops_who_reads_it_and_is_listed(result, change):
    change(result)
    with pytest.raises(DamagedResultError, match=r"events\.nc is not what its job wrote.*Delete"):
        checked(str(result))
    assert damaged(result.parents[1]) == [str(result)]


@pytest.mark.parametrize(
    "change",
    [
        lambda path: path.touch(),
        lambda path: (
            shutil.copy2(path, path.with_name("copy")) and os.replace(f"{path.parent}/copy", path)
        ),
        lambda path: path.write_text("events"),
    ],
    ids=["touched", "copied", "written again"],
)
def test_the_same_content_is_the_same_result_and_is_read_once(result, change, monkeypatch):
    content = digest(result)
    change(result)
    assert checked(str(result)) == content
    assert damaged(result.parents[1]) == []
    # what was found is remembered
    monkeypatch.setattr("burstcast_workflow.tracking.results.digest", None)
    assert checked(str(result)) == content


def test_files_of_others_are_read_and_deleted_ones_are_no_damage(result, tmp_path):
    (tmp_path / "own.csv").write_text("1,2")
    assert checked(str(tmp_path / "own.csv")) == digest(tmp_path / "own.csv")
    result.unlink()
    assert damaged(tmp_path) == []
    assert not list(tmp_path.rglob(".*.sha256"))
    result.write_text("Events")  # of somebody else, or made again
    assert checked(str(result)) == digest(result)
    (result.parent / ".events.nc.sha256").write_text("")  # unreadable
    assert checked(str(result)) == digest(result)


def test_results_are_not_dated_before_their_inputs(tmp_path):
    source, made = tmp_path / "a", tmp_path / "b"
    for path in (source, made):
        path.touch()
    os.utime(source, (5000, 5000))
    os.utime(made, (4000, 4000))
    date_after([str(made)], [str(source)])
    assert made.stat().st_mtime == 5000
    os.utime(made, (6000, 6000))
    date_after([str(made)], [str(source)])
    date_after([str(made)], [])
    assert made.stat().st_mtime == 6000


def test_a_directory_is_an_input_by_its_files(tmp_path):
    """Such as a Zarr store."""
    store = tmp_path / "series.zarr"
    (store / "u").mkdir(parents=True)
    for name, text in (("zarr.json", "{}"), ("u/0", "1 2"), ("u/1", "3 4")):
        (store / name).write_text(text)
    before = checked(str(store))
    (store / "u/1").touch()
    assert checked(str(store)) == before
    (store / "u/1").write_text("3 5")
    assert checked(str(store)) != before
    (store / "u/1").write_text("3 4")
    assert checked(str(store)) == before
    (store / "u/1").rename(store / "u/2")
    assert checked(str(store)) != before
