import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from snaketrust.files import replaced
from snaketrust.records import Records
from snaketrust.run import VARIABLE, OvertakenError, Run, check_ownership

CODE = {"toy.durations@1": "a" * 64, "train.py@2": "b" * 64}


def write_json(path, content):
    with replaced(Path(path), check_ownership) as partial:
        partial.write_text(json.dumps(content))


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(VARIABLE, "")
    return tmp_path


def claimed(**config) -> Run:
    run = Run.new("results/of mine")
    run.claim(config, CODE)
    return run


def test_outside_of_the_workflow_nobody_owns_anything():
    assert Run.current() is None
    write_json("a.json", {})


def test_the_jobs_of_the_newest_run_write():
    claimed()
    write_json("results/of mine/a.json", {"seed": 1})
    assert json.loads(Path("results/of mine/a.json").read_text()) == {"seed": 1}


def test_the_jobs_of_older_runs_do_not():
    first = claimed(seed=1)
    second = claimed(seed=2)
    write_json("results/of mine/a.json", {"seed": 2})
    os.environ[VARIABLE] = f"{first.token} {first.results}"  # in a job that was left behind
    with pytest.raises(OvertakenError, match="results/of mine belongs to a newer run now"):
        write_json("results/of mine/a.json", {"seed": 1})
    with pytest.raises(OvertakenError):
        Records("results/of mine").write(
            ["results/of mine/a.json"], {"rule": "train"}, {}, {}, "a.log", 0.0
        )
    assert sorted(os.listdir("results/of mine")) == [".run.json", "a.json"]
    assert json.loads(Path("results/of mine/a.json").read_text()) == {"seed": 2}
    assert second.plan()["config"] == {"seed": 2}


def test_a_job_that_starts_late_belongs_to_the_run_that_asked_for_it():
    first = claimed()
    claimed()
    with pytest.raises(OvertakenError):
        Run(first.token, first.results).plan()


def test_a_job_must_be_told_which_run_it_belongs_to():
    with pytest.raises(OvertakenError, match=f"variable {VARIABLE} does not reach jobs"):
        Run.of_job()


def test_what_was_planned_is_there_for_all_jobs():
    run = claimed(noise=0.1, cases=["Re400"])
    assert Run.current() == run
    assert run.plan()["config"] == {"noise": 0.1, "cases": ["Re400"]}
    assert run.plan()["code"] == CODE


@pytest.mark.parametrize("text", ["", "[]", "{", "[" * 99999])
def test_a_claim_that_cannot_be_read_belongs_to_an_unknown_run(text):
    run = claimed()
    Path("results/of mine/.run.json").write_text(text)
    with pytest.raises(OvertakenError, match=r"newer run now \(unknown\)"):
        run.plan()
    claimed()


@pytest.mark.parametrize("process", [os.getppid(), "1", None, {}])
@pytest.mark.parametrize("started", [None, ""])
def test_a_claim_that_does_not_say_when_its_run_started_holds_nothing(process, started):
    """Where there is no /proc, nobody can tell."""
    claimed()
    path = Path("results/of mine/.run.json")
    claim = json.loads(path.read_text()) | {"process": process, "started": started}
    path.write_text(json.dumps({name: value for name, value in claim.items() if value is not None}))
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
