"""Records of results, runs that own them, and the files and modules that jobs read."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from snaketrust import records as module
from snaketrust.files import PARTIAL_SUFFIX, digest, remove_partial, replaced, stamp
from snaketrust.modules import UnlikeCodeError, compile_by_content
from snaketrust.records import NO_RECORD, DamagedFileError, Inputs, Records
from snaketrust.run import VARIABLE, OvertakenError, Run, check_ownership


@pytest.fixture(autouse=True)
def outside_of_a_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(VARIABLE, "")


@pytest.fixture
def place(tmp_path):
    for seed in (0, 1):
        Path(f"results/Re400/seed{seed}").mkdir(parents=True)
        write(path_of(seed), f"network {seed}")
    return tmp_path


def path_of(seed=0):
    return f"results/Re400/seed{seed}/network.nc"


def write(path, content, results="results", **inputs):
    """What a job does: its file, then the record."""
    Path(path).write_text(content)
    identity = {"rule": "train", "seed": 0}
    parameters = {"settings": {"number": 0.1, "list": [1, 2.5]}, "code": ["train.py@1"]}
    Records(results).write([path], identity, parameters, inputs, f"{results}/logs/a.log", 1.0)


def problem(path):
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


def change(path, content):
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


UNREADABLE = "", "{", "[]", "{}", '{"path": 3}', "[" * 99999
ODD = [
    *(("stamp", value) for value in (None, 3)),  # with another stamp, the file is read
    *(
        (entry, value)
        for entry in ("digest", "identity", "parameters", "inputs", "log", "seconds")
        for value in (None, 3, [["text"]])
    ),
    *(("identity", value) for value in ({}, {"rule": None})),
    ("inputs", {"Re400/in.nc": 1}),
]


def test_without_a_record_of_the_right_types_a_file_is_no_result(place):
    file = Records("results").file(path_of())
    right = json.loads(file.read_text())
    for text in [*UNREADABLE, *(json.dumps({**right, entry: value}) for entry, value in ODD)]:
        file.write_text(text)
        assert problem(path_of()).startswith(f"the record of {path_of()} cannot be read ("), text
    file.unlink()
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
    def forbidden(*arguments):
        raise PermissionError(13, "Permission denied")

    os.utime(path_of())
    monkeypatch.setattr(Records, "_write", forbidden)
    assert problem(path_of()) == ""


# -- inputs of a job -------------------------------------------------------------------------------
CHANGED = pytest.raises(DamagedFileError, match="changed while the job ran")


def read(*paths):
    return Inputs.read(paths, Records("results"))


def test_an_input_that_is_verified_and_changes_while_the_job_runs_is_an_error(place):
    Path("source.csv").write_text("a")
    paths = path_of(0), path_of(1), "source.csv"
    inputs = read(*paths)
    assert inputs.by_path == {path: digest(path) for path in paths}
    os.utime(path_of())  # as Snakemake does
    inputs.check()
    for change_it in (os.unlink, lambda path: Path(path).write_text("network 7")):
        change_it(path_of())
        with CHANGED:
            inputs.check()


def test_where_times_are_whole_seconds_equal_stamps_say_nothing(place, monkeypatch):
    """FAT has even ones: an edit within the same two seconds leaves size and times alone."""
    even = 10**18
    monkeypatch.setattr(module, "stamp", lambda path: [os.stat(path).st_size, even, even, 1])
    monkeypatch.setattr(module, "_LARGE", 0)
    write(path_of(1), "network 1")
    assert problem(path_of(1)) == ""
    inputs = read(path_of(1))
    Path(path_of(1)).write_text("network 7")
    assert problem(path_of(1)) == f"{path_of(1)} is not what its job wrote"
    with CHANGED:
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


def test_what_killed_writers_of_a_file_have_left_behind_is_removed(tmp_path):
    path = tmp_path / "a.json"
    with replaced(path) as partial:
        partial.write_text("whole")
    assert [one.name for one in tmp_path.iterdir()] == ["a.json"]
    left = [tmp_path / f".a.json.{number:012x}{PARTIAL_SUFFIX}" for number in range(2)]
    of_others = (f".{name}.{0:012x}{PARTIAL_SUFFIX}" for name in ("b.json", "a.json.gz"))
    others = [tmp_path / name for name in (*of_others, ".a.json.txt", "a.txt")]
    for one in [*left, *others]:
        one.write_text("")
    remove_partial(path)
    assert not any(one.exists() for one in left)
    assert all(one.exists() for one in others)
    assert path.read_text() == "whole"


# -- runs ------------------------------------------------------------------------------------------

CODE = {"toy.durations@1": "a" * 64, "train.py@2": "b" * 64}


def write_json(path, content):
    with replaced(Path(path), check_ownership) as partial:
        partial.write_text(json.dumps(content))


def claimed(**config):
    run = Run.new("results/of mine")
    run.claim(config, CODE)
    return run


def test_only_jobs_of_the_newest_run_write_and_outside_of_a_workflow_nobody_owns_anything():
    assert Run.current() is None
    write_json("a.json", {})
    with pytest.raises(OvertakenError, match=f"variable {VARIABLE} does not reach jobs"):
        Run.of_job()
    first = claimed(seed=1)
    write_json("results/of mine/a.json", {"seed": 1})
    second = claimed(seed=2, cases=["Re400"])
    assert Run.current() == Run.of_job() == second
    assert second.plan()["config"] == {"seed": 2, "cases": ["Re400"]}
    assert second.plan()["code"] == CODE
    write_json("results/of mine/a.json", {"seed": 2})
    os.environ[VARIABLE] = f"{first.token} {first.results}"  # in a job that was left behind
    for late in (
        lambda: write_json("results/of mine/a.json", {"seed": 1}),
        lambda: write("results/of mine/a.json", '{"seed": 2}', "results/of mine"),
        Run(first.token, first.results).plan,
    ):
        with pytest.raises(OvertakenError, match="results/of mine belongs to a newer run now"):
            late()
    assert sorted(os.listdir("results/of mine")) == [".run.json", "a.json"]
    assert json.loads(Path("results/of mine/a.json").read_text()) == {"seed": 2}


@pytest.mark.parametrize("text", ["", "[]", "{", "[" * 99999])
def test_a_claim_that_cannot_be_read_belongs_to_an_unknown_run(text):
    run = claimed()
    Path("results/of mine/.run.json").write_text(text)
    with pytest.raises(OvertakenError, match=r"newer run now \(unknown\)"):
        run.plan()
    claimed()


def test_a_claim_that_does_not_say_when_its_run_started_holds_nothing():
    """Where there is no /proc, nobody can tell."""
    claimed()
    path = Path("results/of mine/.run.json")
    claim = json.loads(path.read_text())
    del claim["started"]
    for process in (os.getppid(), "1", None, {}):
        for started in ({}, {"started": ""}):
            odd = claim | {"process": process} | started
            path.write_text(json.dumps({name: odd[name] for name in odd if odd[name] is not None}))
            claimed()


def test_a_run_that_is_alive_keeps_its_results():
    code = (
        "from snaketrust.run import Run; import sys; "
        "Run.new('results/of mine').claim({}, {}); print('claimed', flush=True); sys.stdin.read()"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as other:
        assert other.stdout.readline() == "claimed\n"
        with pytest.raises(OvertakenError, match=f"another run, process {other.pid}, is at work"):
            claimed()
        other.kill()
        other.wait()
        claimed()


# -- compiled modules ------------------------------------------------------------------------------


@pytest.fixture
def once_compiled(tmp_path):
    """A module of a package, which Python has compiled once."""
    package = tmp_path / "example"
    package.mkdir()
    (package / "__init__.py").write_text("")
    path = package / "numbers.py"
    path.write_text("VALUE = 1\n")
    assert imported(tmp_path) == 1
    return path


def imported(sources):
    command = [sys.executable, "-c", "import example.numbers as n; print(n.VALUE)"]
    variables = {name: text for name, text in os.environ.items() if not name.startswith("PYTHON")}
    environment = {**variables, "PYTHONPATH": str(sources)}
    return int(subprocess.check_output(command, env=environment))


def test_an_edit_that_keeps_size_and_time_is_run(once_compiled, tmp_path):
    change(once_compiled, "VALUE = 2\n")
    assert imported(tmp_path) == 1  # what Python does by itself
    compile_by_content([once_compiled])
    assert imported(tmp_path) == 2
    change(once_compiled, "VALUE = 3\n")
    assert imported(tmp_path) == 3  # and from then on
    compile_by_content([once_compiled])
    assert imported(tmp_path) == 3


def test_a_process_that_runs_an_old_compiled_module_is_told(once_compiled, tmp_path, monkeypatch):
    loaded = type(sys)("example.numbers")
    loaded.__file__ = str(once_compiled)
    monkeypatch.setitem(sys.modules, "example.numbers", loaded)
    monkeypatch.setattr(sys, "pycache_prefix", None)
    compile_by_content([once_compiled])  # nothing is wrong
    for compiled in tmp_path.rglob("*.pyc"):
        compiled.unlink()
    assert imported(tmp_path) == 1
    change(once_compiled, "VALUE = 2\n")
    with pytest.raises(UnlikeCodeError, match=r"compiled numbers\.py from another"):
        compile_by_content([once_compiled])
    compile_by_content([once_compiled])


def test_a_directory_is_what_its_files_are():
    for name in ("a", "b"):
        Path(name, "c").mkdir(parents=True)
        Path(name, "c", "0").write_text("one")
    assert digest("a") == digest("b")
    inputs = Inputs.read(["a"], None)
    inputs.check()
    Path("a/c/0").write_text("two")  # no state of `a` itself changes
    with pytest.raises(DamagedFileError, match="a changed while the job ran"):
        inputs.check()
    Path("b/c/0").rename("b/c/1")
    assert len({digest("a"), digest("b"), inputs.by_path["a"]}) == 3
