"""The frame in which a script runs as a job: its files, its settings, its code, its failures."""

import json
import os
import re
import signal
import sys
import textwrap
import time
import warnings
from tempfile import TemporaryFile
from types import SimpleNamespace

import numpy as np
import pytest
from helpers_configs import ROOT
from snakemake.iocontainers import Namedlist

from burstcast_workflow.harness.call import Call
from burstcast_workflow.harness.job import JobSettings, at
from burstcast_workflow.harness.logs import cache_summary, failure_summary
from burstcast_workflow.harness.running import run_job
from burstcast_workflow.harness.storage import atomic, write_json
from burstcast_workflow.tracking.code import Sources
from burstcast_workflow.tracking.results import DamagedResultError, Notes, checked, noted
from burstcast_workflow.tracking.run import begin

HEADER = """
from pathlib import Path
from types import SimpleNamespace

Path("data.nc").write_text("data")
script = Path("train.py").resolve()
script.write_text("import burstcast.base.durations as d; d.steps")
sources = Sources(lambda name: script, SOURCES, {})
code = sources.code("train.py", {})
begin("deep", {}, sources.whole(), [os.path.abspath("mine")], "abc")

snakemake = SimpleNamespace(
    rule="train", resources={}, scriptdir=str(script.parent), log=["logs/train.log"],
    wildcards={"case": "Re400", "seed": "3"},
    input=files(data="data.nc"), output=files(network="deep/er/network.json"),
    config={"results": "deep"},
    params=files(settings={"number": 3, "name": "Re400"}, code=code),
)
"""
MAIN = "def main(*, data, network, settings: Named):\n"


class Named(JobSettings):
    name: str = at("name")
    number: int = at("number")
    neurons: int = at("neurons")


# what a script finds beside its own text
GIVEN = {
    **{"os": os, "time": time, "np": np, "files": lambda **items: Namedlist(fromdict=items)},
    **{"SOURCES": ROOT / "src", "Sources": Sources, "begin": begin, "Namedlist": Namedlist},
    **{"atomic": atomic, "write_json": write_json, "run_job": run_job, "Call": Call},
    **{"Named": Named},
}


def started(directory, body, channels):
    """A process that runs a job in a directory; its outputs are appended to files."""
    child = os.fork()
    if child:
        return child
    status = 1
    try:
        os.chdir(directory)
        for number, file in enumerate(channels, 1):
            os.dup2(file.fileno(), number)
        sys.stdout, sys.stderr = (open(n, "w", closefd=False) for n in (1, 2))  # noqa: SIM115
        warnings.resetwarnings()
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            signal.signal(number, signal.SIG_DFL)  # whatever the shell of these tests ignores
        names = {"__name__": "__main__", **GIVEN}
        exec(f"{HEADER}{textwrap.dedent(body)}\nrun_job(snakemake, main, Call)\n", names)
        status = 0
    except SystemExit as stop:
        status = stop.code if isinstance(stop.code, int) else 1
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)


def run(directory, body):
    """Run a job: how it ended, with what it said on both channels, and its log."""
    with TemporaryFile("w+") as out, TemporaryFile("w+") as error:
        _, status = os.waitpid(started(directory, body, (out, error)), 0)
        texts = []
        for file in (out, error):
            file.seek(0)
            texts.append(file.read())
    result = SimpleNamespace(returncode=os.waitstatus_to_exitcode(status))
    result.stdout, result.stderr = texts
    return result, (directory / "logs" / "train.log").read_text()


def test_success(tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "own_flow.py").write_text("RATE = 2")
    body = f"""{MAIN}
    import own_flow
    print("from print")
    os.system("echo from a child")
    os.write(2, b"from compiled code")
    np.log(np.zeros(1))
    time.sleep(0.2)
    until = time.process_time() + 0.3
    while time.process_time() < until:
        pass
    script.write_text("import burstcast.base.durations as d; d.steps  # no edit")
    assert data == "data.nc"
    read = {{"name": settings.name, "number": settings.number, "rate": own_flow.RATE}}
    write_json(network, {{"read": read, "provenance": settings.provenance}})
    """
    result, log = run(tmp_path, body)
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
    record = json.loads((tmp_path / "deep" / "er" / "network.json").read_text())
    assert record["read"] == {"name": "Re400", "number": 3, "rate": 2}
    assert 'train (case=Re400, seed=3) starts with settings {"name": "Re400", "number": 3}' in log
    for text in ("from print", "from a child", "from compiled code", "RuntimeWarning: divide"):
        assert text in log
    assert "is done: " in log
    assert "MiB" in log
    wall, processor = map(
        float, re.search(r"computed in (.+) s, (.+) s of processor", log).groups()
    )
    assert processor >= 0.3
    assert wall >= 0.5  # it has slept, too
    assert "settings not read" not in log
    (entry,) = (tmp_path / ".burstcast_cache").rglob("entry.json")
    assert 0.2 <= json.loads(entry.read_text())["seconds"] < 60


def test_failure_is_one_line_and_a_traceback_in_the_log(tmp_path):
    result, log = run(tmp_path, f'{MAIN}    raise ValueError("series are\\n  too short")')
    assert (result.returncode, result.stdout) == (1, "")
    assert result.stderr == (
        "train (case=Re400, seed=3) failed: ValueError: series are too short "
        "(log: logs/train.log)\n"
    )
    assert "Traceback" in log
    assert "train (case=Re400, seed=3) failed: " in log


def main_with(parameters):
    return f"def main({parameters}): open('ran', 'w')"


@pytest.mark.parametrize(
    ("body", "complaint"),
    [
        (
            f"{MAIN}    settings.neurons",
            "UndeclaredSettingError: train reads the setting neurons, which does not concern it; "
            "its settings are: name, number (log:",
        ),
        (main_with("*, network, settings"), "unexpected keyword argument 'data'"),
        (main_with("*, data, settings"), "unexpected keyword argument 'network'"),
        (
            main_with("*, data, network, settings, other"),
            "missing 1 required keyword-only argument: 'other'",
        ),
        (
            f'script.write_text("EDITED = 1")\n{MAIN}    open("ran")',
            "UnlikeCodeError: train.py changed after the workflow was planned",
        ),
        (
            f'{MAIN}    script.write_text("EDITED = 1")',
            "train.py changed after the workflow was planned",
        ),
    ],
)
def test_a_job_that_is_not_what_its_rule_says_fails(tmp_path, body, complaint):
    """Settings, files, and the code that was planned, before and after its work."""
    result, _ = run(tmp_path, body)
    assert result.returncode == 1
    assert complaint in result.stderr
    assert not (tmp_path / "ran").exists()


def test_outputs_come_from_the_cache_with_their_log(tmp_path):
    body = f"{MAIN}    settings.name, print('computed'), write_json(network, {{}})"
    first = run(tmp_path, body)[1]
    output = tmp_path / "deep" / "er" / "network.json"
    content = output.read_bytes()
    output.unlink()
    second = run(tmp_path, f"{MAIN}    raise ValueError('computed again')")[1]
    assert output.read_bytes() == content
    assert checked(str(output))
    written = noted(output)
    assert (written.place, {*written.making.inputs}) == ("er/network.json", {"data.nc"})
    for log in (first, second):
        assert "computed\n" in log
        assert log.count(" s of processor\n") == 1  # of the job that computed
        assert "settings not read: number" in log
        assert "is done: " in log.splitlines()[-1]
    assert "taken from the cache: the outputs are those of this job, which took " in second
    assert "the outputs are" not in first
    assert cache_summary(tmp_path, 0.0) == "1 of 1 jobs took their results from the cache."
    assert cache_summary(tmp_path, time.time() + 60) == ""


@pytest.mark.parametrize(
    "change",
    [
        "snakemake.params.settings = {'number': 4, 'name': 'Re400'}",
        'snakemake.wildcards["seed"] = "4"',
        'Path("data.nc").write_text("other")',
        'snakemake.output = files(network="deep/er/other.json")',
        'Path("data.nc").rename("other.nc"); snakemake.input = files(data="other.nc")',
        "from burstcast_workflow.tracking import environment; environment.platform.machine = str",
    ],
    ids=["setting", "wildcard", "input", "output", "name of an input", "machine"],
)
def test_a_job_that_depends_on_something_else_computes(tmp_path, change):
    body = f"{MAIN}    write_json(network, {{}})\n    open('ran', 'a').write('x')"
    run(tmp_path, body)
    run(tmp_path, body)
    assert (tmp_path / "ran").read_text() == "x"
    assert run(tmp_path, f"{change}\n{body}")[0].returncode == 0
    assert (tmp_path / "ran").read_text() == "xx"


def test_what_a_killed_job_leaves_is_removed_and_not_taken_for_a_damaged_result(tmp_path):
    leftover = tmp_path / "deep/er/.network.json.0123.partial"
    leftover.parent.mkdir(parents=True)
    leftover.write_text("half")
    body = f"{MAIN}    write_json(network, {{}})"
    run(tmp_path, body)
    assert not leftover.exists()
    killed = f"snakemake.wildcards['seed'] = '4'\n{MAIN}    write_json(network, [1]), os._exit(9)"
    assert run(tmp_path, killed)[0].returncode == 9
    assert (tmp_path / "deep/er/network.json").read_text() == "[\n  1\n]\n"
    assert Notes.of(tmp_path).damaged() == []


@pytest.mark.parametrize("held_up", ["environment", "_dated"])
def test_a_job_that_is_overtaken_leaves_a_newer_run_its_result(tmp_path, held_up):
    # held up before its outputs are cleared, or after they were made: meanwhile, a newer run begins
    # and makes the same output
    newer = f"""
    import burstcast_workflow.harness.running as running
    from burstcast_workflow.tracking.results import Making, digest, note

    held_up = running.{held_up}

    def overtaken(*arguments):
        former, result = os.environ["BURSTCAST_RUN"], Path("deep/er/network.json")
        begin("deep", {{}}, sources.whole(), [], "abc")
        result.parent.mkdir(exist_ok=True)
        result.write_text('"of the newer run"')
        note(result, digest(result), "er/network.json", Making("newer", {{}}))
        os.environ["BURSTCAST_RUN"] = former
        return held_up(*arguments)

    running.{held_up} = overtaken
    {MAIN}        write_json(network, "of the older run")
    """
    result, _ = run(tmp_path, newer)
    assert result.returncode == 1
    assert "deep belongs to a newer run" in result.stderr
    made = tmp_path / "deep" / "er" / "network.json"
    assert json.loads(made.read_text()) == "of the newer run"
    assert noted(made).making.parameters == "newer"
    assert checked(made)


def test_a_damaged_input_stops_the_job(tmp_path):
    damage = """
from burstcast_workflow.tracking.results import Making, note
note("data.nc", "0" * 64, "data.nc", Making("", {}))
os.utime("data.nc", (1, 1))
"""
    result, _ = run(tmp_path, f"{damage}{MAIN}    open('ran', 'w')")
    assert DamagedResultError.__name__ in result.stderr
    assert "data.nc is not what its job wrote" in result.stderr
    assert not (tmp_path / "ran").exists()


def test_an_input_that_changes_while_the_job_runs_is_noticed(tmp_path):
    result, _ = run(tmp_path, f"{MAIN}    write_json(network, {{}}), Path(data).write_text('new')")
    assert "an input has changed while the job ran" in result.stderr
    assert not list((tmp_path / ".burstcast_cache").rglob("entry.json"))


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGKILL])
def test_a_stopped_job_cleans_up_and_a_killed_one_leaves_nothing_finished(tmp_path, number):
    waiting = """
    with atomic(network) as partial:
        partial.write_text("half")
        open("ready", "w").close()
        time.sleep(600)
    """
    with TemporaryFile() as output:
        job = started(tmp_path, MAIN + waiting, (output, output))
        deadline = time.monotonic() + 300
        while not (tmp_path / "ready").exists():
            assert time.monotonic() < deadline
            time.sleep(0.02)
        os.kill(job, number)
        _, status = os.waitpid(job, 0)
    files = [path.name for path in (tmp_path / "deep" / "er").iterdir()]
    if number == signal.SIGKILL:
        assert os.waitstatus_to_exitcode(status) == -number
        files = [name for name in files if not name.endswith(".partial")]
    assert status != 0
    assert files == []


# -- the ends of logs ------------------------------------------------------------------------------


def write(path, text, age=0.0):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    os.utime(path, (time.time() - age, time.time() - age))
    return str(path)


def failures(directory, age):
    return failure_summary(directory / "logs", directory / "slurm", time.time() - age)


def test_failure_summary_has_the_ends_of_logs_of_failed_and_killed_jobs_by_time(tmp_path):
    logs = tmp_path / "logs"
    write(logs / "train" / "a.log", "starts\nINFO train (seed=1) is done: 1.00 s\n")
    write(logs / "fine.log", "x is done: 1 s\n\n", age=5)
    write(logs / "old.log", "ValueError: long ago\n", age=3600)
    assert failures(tmp_path, 60) == ""
    lines = "".join(f"line {number}\n" for number in range(50))
    failed = write(logs / "b.log", lines + "ValueError: bad\n", age=20)
    killed = write(logs / "a.log", "", age=10)
    of_slurm = write(tmp_path / "slurm" / "group" / "7.log", "exceeded memory limit\n")
    text = failures(tmp_path, 60)
    assert text.index(failed) < text.index(killed) < text.index(of_slurm)
    # twelve lines of each in all
    for line in ("ValueError: bad", "(empty)", "exceeded memory limit", "line 49", "line 39\n"):
        assert line in text
    assert "line 38\n" not in text
    assert "fine.log" not in text
    # many are listed by name only
    for number in range(25):
        write(logs / f"{number}.log", f"reason {number}\n", age=1000 - number)
    text = failures(tmp_path, 2000)
    for line in ("reason 0", "17 more", "24.log"):
        assert line in text
    assert "reason 24" not in text
