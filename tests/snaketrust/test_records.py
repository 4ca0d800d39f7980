import json
import os
from pathlib import Path

import pytest

from snaketrust import records as module
from snaketrust.files import digest, stamp
from snaketrust.records import NO_RECORD, DamagedFileError, Inputs, Records


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for seed in (0, 1):
        Path(f"results/Re400/seed{seed}").mkdir(parents=True)
        write(path_of(seed), f"network {seed}")
    return tmp_path


def path_of(seed: int = 0) -> str:
    return f"results/Re400/seed{seed}/network.nc"


def write(path: str, content: str, results: str = "results", **inputs: str) -> None:
    """What a job does: its file, then the record."""
    Path(path).write_text(content)
    identity = {"rule": "train", "seed": 0}
    parameters = {"settings": {"number": 0.1, "list": [1, 2.5]}, "code": ["train.py@1"]}
    Records(results).write([path], identity, parameters, inputs, f"{results}/logs/a.log", 1.0)


def problem(path: str) -> str:
    return Records("results").found(path)[1]


def test_a_record_says_what_made_a_file(place):
    write(path_of(), "network", **{"results/Re400/in.nc": "1" * 64, "sources/a.csv": "2" * 64})
    record, nothing = Records("results").found(path_of())
    assert (record.path, nothing) == ("Re400/seed0/network.nc", "")
    assert record.digest == digest(path_of())
    assert record.identity == {"rule": "train", "seed": 0}
    # Snakemake compares representations
    settings = record.parameters["settings"]
    assert repr(settings) == repr({"number": 0.1, "list": [1, 2.5]})
    assert record.inputs == {"Re400/in.nc": "1" * 64, "../sources/a.csv": "2" * 64}
    assert record.log == "logs/a.log"


def test_results_may_be_spelt_otherwise_and_moved(place):
    assert Records(f"{place}/results").found(f"{place}/{path_of()}")[1] == ""
    os.rename("results", "elsewhere")
    found, _ = Records("elsewhere").found("elsewhere/Re400/seed0/network.nc")
    assert found is not None
    names = ["Re400/a.nc", "../sources/a.csv"]
    for results in ("results", f"{place}/results"):
        records = Records(results)
        assert [records.name(records.path(name)) for name in names] == names


def change(path: str, content: str) -> None:
    """Change a file in place, and put its times back."""
    state = os.stat(path)
    with open(path, "r+") as file:
        file.write(content)
        file.truncate()
    os.utime(path, ns=(state.st_atime_ns, state.st_mtime_ns))


@pytest.mark.parametrize("large", [False, True])
@pytest.mark.parametrize("content", ["network 1", "network", "network 00", ""])
def test_a_changed_file_is_no_result(place, monkeypatch, large, content):
    monkeypatch.setattr(module, "_LARGE", 0 if large else 10**9)
    change(path_of(), content)
    assert problem(path_of()) == f"{path_of()} is not what its job wrote"


def test_exchanged_files_are_no_results(place):
    first, second = path_of(0), path_of(1)
    records = [Records("results").file(path) for path in (first, second)]
    os.rename(first, "temporary")
    os.rename(second, first)
    os.rename("temporary", second)
    for path in (first, second):
        assert problem(path) == f"{path} is not what its job wrote"
    # together with their records
    os.rename(records[0], "temporary")
    os.rename(records[1], records[0])
    os.rename("temporary", records[1])
    assert problem(first) == (
        f"the record of {first} belongs to another file, Re400/seed1/network.nc"
    )


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", '{"path": 3}', "[" * 99999])
def test_a_record_that_cannot_be_read_is_none(place, text):
    Records("results").file(path_of()).write_text(text)
    assert problem(path_of()).startswith(f"the record of {path_of()} cannot be read (")


ENTRIES = ("digest", "stamp", "identity", "parameters", "inputs", "log", "seconds")


@pytest.mark.parametrize(
    ("entry", "value"),
    [
        *((entry, value) for entry in ENTRIES for value in (None, 3, [["text"]])),
        *(("identity", value) for value in ({}, {"rule": None})),
        ("inputs", {"Re400/in.nc": 1}),
    ],
)
def test_a_record_with_an_entry_of_another_type_is_none(place, entry, value):
    if (entry, value) == ("stamp", [["text"]]):
        return  # the file is read, as if it had changed
    file = Records("results").file(path_of())
    file.write_text(json.dumps({**json.loads(file.read_text()), entry: value}))
    assert problem(path_of()).startswith(f"the record of {path_of()} cannot be read (")


def test_a_file_without_a_record_is_no_result(place):
    Records("results").file(path_of()).unlink()
    assert problem(path_of()) == NO_RECORD


def test_a_file_that_is_touched_or_copied_is_read_once(place, monkeypatch):
    monkeypatch.setattr(module, "_LARGE", 0)
    calls = []
    monkeypatch.setattr(module, "digest", lambda path: calls.append(path) or digest(path))
    assert problem(path_of()) == ""
    assert calls == []
    os.utime(path_of())
    assert [problem(path_of()) for _ in range(3)] == ["", "", ""]
    assert calls == [path_of()]


def test_results_that_may_only_be_read_are_used(place, monkeypatch):
    os.utime(path_of())

    def forbidden(*arguments):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Records, "_write", forbidden)
    assert problem(path_of()) == ""


# -- inputs of a job -------------------------------------------------------------------------------


def read(*paths: str) -> Inputs:
    return Inputs.read(paths, Records("results"))


def test_inputs_are_verified(place):
    Path("source.csv").write_text("a")
    inputs = read(path_of(0), path_of(1), "source.csv")
    assert inputs.by_path == {path: digest(path) for path in (path_of(0), path_of(1), "source.csv")}
    inputs.check()


def test_a_damaged_input_is_an_error_that_says_how_to_repair_it(place):
    change(path_of(1), "network 7")
    with pytest.raises(DamagedFileError) as error:
        read(path_of(0), path_of(1))
    assert str(error.value) == (
        f"{path_of(1)} is not what its job wrote: remove it (rm {path_of(1)}), and run again"
    )


def test_a_small_input_is_read_whatever_its_stamp_says(place):
    """A disk that has lost a bit sets no times."""
    change(path_of(), "network 7")
    file = Records("results").file(path_of())
    record = json.loads(file.read_text())
    file.write_text(json.dumps({**record, "stamp": stamp(path_of())}))
    assert problem(path_of()) == ""
    with pytest.raises(DamagedFileError):
        read(path_of())


def test_an_input_that_changes_while_the_job_runs_is_an_error(place):
    inputs = read(path_of())
    os.utime(path_of())  # as Snakemake does
    inputs.check()
    Path(path_of()).rename("away")
    with pytest.raises(DamagedFileError, match="changed while the job ran"):
        inputs.check()
    Path("away").rename(path_of())
    Path(path_of()).write_text("network 7")
    with pytest.raises(DamagedFileError, match="changed while the job ran"):
        inputs.check()
