"""Notes beside results: what is not what its job wrote, in its place, from what is there now."""

import os
import shutil

import pytest

from burstcast_workflow.tracking.results import (
    DamagedResultError,
    Making,
    Notes,
    checked,
    date_after,
    digest,
    forget,
    note,
    noted,
    parameters_hash,
    place_in,
)

PARAMETERS = ["a = 1", "b.py @12", ""]


def made(results, name, text, inputs=(), parameters=PARAMETERS):
    """A result as a job leaves it."""
    path = results / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    contents = {other: digest(results / other) for other in inputs}
    note(path, digest(path), name, Making(parameters_hash(parameters), contents))
    return path


@pytest.fixture
def result(tmp_path):
    return made(tmp_path, "Re400/events.nc", "events")


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
        lambda path: keeping_time(path, lambda path: path.write_text("Events")),  # another time
    ],
    ids=["edited", "cut off", "emptied", "cut off, old", "exchanged, old", "edited, old"],
)
def test_a_result_that_was_changed_stops_who_reads_it_and_is_listed(result, change):
    change(result)
    with pytest.raises(DamagedResultError, match=r"events\.nc is not what its job wrote.*Delete"):
        checked(str(result))
    (fault,) = Notes.of(result.parents[1]).damaged()
    assert fault.startswith(f"{result} is not what its job wrote")


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
    notes = Notes.of(result.parents[1])
    assert notes.damaged() == []
    notes.stamp()  # what was found is remembered
    monkeypatch.setattr("burstcast_workflow.tracking.results.digest", None)
    assert checked(str(result)) == content


def test_files_of_others_are_read_and_deleted_ones_are_no_damage(result, tmp_path):
    (tmp_path / "own.csv").write_text("1,2")
    assert checked(str(tmp_path / "own.csv")) == digest(tmp_path / "own.csv")
    result.unlink()
    assert Notes.of(tmp_path).damaged() == []
    assert noted(result)  # looking changes nothing
    forget(result)
    result.write_text("Events")  # of somebody else, or made again
    assert checked(str(result)) == digest(result)
    (result.parent / ".events.nc.sha256").write_text("")  # unreadable
    assert checked(str(result)) == digest(result)


def test_a_result_belongs_to_its_place(tmp_path):
    """Not so the directory that all results lie in."""
    first = made(tmp_path / "results", "a/esn-N30/forecaster.nc", "30")
    second = made(tmp_path / "results", "a/esn-N40/forecaster.nc", "40")
    shutil.copytree(tmp_path / "results", tmp_path / "elsewhere")
    assert Notes.of(tmp_path / "elsewhere").damaged() == []
    shutil.copytree(first.parent, second.parent, dirs_exist_ok=True)
    (fault,) = Notes.of(tmp_path / "results").damaged()
    assert fault == (
        f"{second} is a copy of a/esn-N30/forecaster.nc, and not what its own job wrote"
    )
    with pytest.raises(DamagedResultError, match="is a copy of a/esn-N30"):
        checked(str(second))


@pytest.mark.parametrize(
    ("results", "path", "place"),
    [
        ("results/tiny", "results/tiny/Re400/events.nc", "Re400/events.nc"),
        ("./results/tiny/", "results/tiny/report.html", "report.html"),
        ("results/tiny", ".snakemake/storage/fs/results/tiny/Re400/a.nc", "Re400/a.nc"),
        ("/data/results", "/data/results/Re400/a.nc", "Re400/a.nc"),
        ("results/tiny", "data/run.csv", "data/run.csv"),
    ],
)
def test_places_are_below_the_results(results, path, place):
    assert place_in(results, path) == place


def recorded(parameters, **inputs):
    """As Snakemake keeps parameters, and digests of inputs."""
    return sorted(map(repr, parameters or [])), inputs


OTHERS = [*PARAMETERS, "c = 3"]


@pytest.mark.parametrize(
    ("record", "now", "expected"),
    [
        (PARAMETERS, PARAMETERS, True),
        (PARAMETERS, OTHERS, True),  # Snakemake sees it by itself
        (None, PARAMETERS, True),  # its record was lost
        (None, OTHERS, False),
        (OTHERS, PARAMETERS, True),  # it made them anew elsewhere: not stale, whatever it knows
        (OTHERS, OTHERS, False),  # an older copy was put in the place of what it made
    ],
)
def test_a_result_is_believed_if_it_is_of_the_parameters_of_its_job(
    tmp_path, record, now, expected
):
    path = made(tmp_path, "a/table.csv", "1")
    record = recorded(record)
    assert Notes.of(tmp_path).is_up_to_date(str(path), record, lambda: now) == expected
    forget(path)
    assert not Notes.of(tmp_path).is_up_to_date(str(path), record, lambda: now)  # of no job


@pytest.mark.parametrize("known", [False, True])
@pytest.mark.parametrize("newer", [False, True])
def test_a_result_of_other_inputs_is_noticed_whatever_the_dates(tmp_path, newer, known):
    """``known``: Snakemake made another result of these inputs, in whose place an older one is."""
    first = made(tmp_path, "a/series.nc", "1")
    second = made(tmp_path, "a/table.csv", "2", ["a/series.nc"])

    def is_believed():
        notes, record = Notes.of(tmp_path), recorded(PARAMETERS)
        if known and first.exists():
            record[1][str(first)] = f"sha256:{digest(first)}"
        return notes.is_up_to_date(str(second), record, lambda: PARAMETERS)

    assert is_believed()
    made(tmp_path, "a/series.nc", "one")
    os.utime(second, (5000, 5000))
    os.utime(first, (6000, 6000) if newer else (4000, 4000))
    # Snakemake sees newer inputs by itself, unless it knows their contents
    assert is_believed() == (newer and not known)
    first.unlink()  # it will be made again
    assert is_believed()


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
