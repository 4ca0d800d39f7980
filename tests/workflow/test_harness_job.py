"""The frame in which a script runs as a job: its files, its settings, its code, its failures."""

import json
import os
import signal
import subprocess
import sys
import textwrap
import time

import pytest

from burstcast_workflow.harness import environment
from burstcast_workflow.harness.failures import failure_summary

HEADER = """
import os, sys, time
import numpy as np
from pathlib import Path
from types import SimpleNamespace
from dataclasses import replace
from snakemake.iocontainers import Namedlist
import burstcast
from burstcast_workflow.project import code_of
from snaketrust.fingerprint import Sources
from burstcast_workflow.harness.job import run_job
from burstcast_workflow.harness.storage import atomic, write_json

def Files(**items):
    return Namedlist(fromdict=items)

Path("data.nc").write_text("data")
script = Path("train.py").resolve()
script.write_text("import burstcast.durations")
project = code_of(Path(burstcast.__path__[0]).parents[1])
sources = Sources(replace(project, scripts=script.parent))
code = sources.fingerprint("train.py")

snakemake = SimpleNamespace(
    rule="train", resources={}, scriptdir=str(script.parent), log=["logs/train.log"],
    wildcards={"case": "Re400", "seed": "3"},
    input=Files(data="data.nc"), output=Files(network="deep/er/network.json"),
    params=Files(settings={"number": 3.0, "name": "Re400"}, code=code),
)
"""


def script(body: str) -> list[str]:
    code = HEADER + textwrap.dedent(body) + "\nrun_job(snakemake, main)\n"
    return [sys.executable, "-c", code]


def run(tmp_path, body: str):
    result = subprocess.run(script(body), cwd=tmp_path, capture_output=True, text=True)
    return result, (tmp_path / "logs" / "train.log").read_text()


def test_success(tmp_path):
    result, log = run(
        tmp_path,
        """
        def main(*, data, network, settings):
            print("from print")
            os.system("echo from a child")
            os.write(2, b"from compiled code")
            np.log(np.zeros(1))
            assert data == "data.nc"
            write_json(network, {"settings": dict(settings), "provenance": settings.provenance})
        """,
    )
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
    record = json.loads((tmp_path / "deep" / "er" / "network.json").read_text())
    assert record["settings"] == {"name": "Re400", "number": 3}
    assert 'train (case=Re400, seed=3) starts with settings {"name": "Re400", "number": 3}' in log
    for text in ("from print", "from a child", "from compiled code", "RuntimeWarning: divide"):
        assert text in log
    assert "is done: 0." in log
    assert "MiB" in log


def test_a_job_of_a_run_finds_own_modules_and_records_how_long_it_took(tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "own_flow.py").write_text("RATE = 2")
    result, log = run(
        tmp_path,
        """
        from snaketrust.run import Run
        Run.new("results").claim({}, sources.all_code(), [os.path.abspath("mine")])
        snakemake.output = Files(network="results/network.json")
        def main(*, data, network, settings):
            import own_flow
            time.sleep(0.2)
            write_json(network, {"rate": own_flow.RATE})
        """,
    )
    assert result.returncode == 0, log
    record = json.loads((tmp_path / "results" / ".records" / "network.json.json").read_text())
    assert 0.2 <= record["seconds"] < 60
    assert record["parameters"]["settings"] == {"name": "Re400", "number": 3}


def test_provenance_has_versions_and_nothing_of_time_machine_or_path(tmp_path):
    records = []
    for name in ("first", "second"):
        (tmp_path / name).mkdir()
        run(
            tmp_path / name,
            """
            def main(*, data, network, settings):
                write_json(network, settings.provenance)
            """,
        )
        records.append((tmp_path / name / "deep" / "er" / "network.json").read_bytes())
    assert records[0] == records[1]
    record = json.loads(records[0])
    libraries = {"numpy", "scipy", "llvmlite", "scikit-learn", "scikit-optimize"}
    assert set(record) == {"source", "rule", "identity", "settings", "python"} | libraries
    assert record["source"].startswith("burstcast ")
    assert record["identity"] == '{"case": "Re400", "rule": "train", "seed": 3}'
    assert record["settings"] == '{"name": "Re400", "number": 3}'
    assert all(isinstance(value, str) for value in record.values())


def test_failure_is_one_line_and_a_traceback_in_the_log(tmp_path):
    result, log = run(
        tmp_path,
        """
        def main(*, data, network, settings):
            raise ValueError("series are\\n  too short")
        """,
    )
    assert result.returncode == 1
    assert result.stdout == ""
    assert result.stderr == (
        "train (case=Re400, seed=3) failed: ValueError: series are too short "
        "(log: logs/train.log)\n"
    )
    assert "Traceback" in log
    assert "train (case=Re400, seed=3) failed: 0." in log


def test_settings_that_snakemake_does_not_track_are_refused(tmp_path):
    result, _ = run(
        tmp_path,
        """
        snakemake.params.settings["neurons"] = np.int64(3)
        def main(*, data, network, settings):
            raise AssertionError("must not run")
        """,
    )
    assert result.returncode == 1
    assert "TypeError: params.settings.neurons is" in result.stderr


def test_a_setting_that_the_rule_does_not_declare_is_an_error(tmp_path):
    result, _ = run(
        tmp_path,
        """
        def main(*, data, network, settings):
            settings["neurons"]
        """,
    )
    assert result.returncode == 1
    assert (
        "UndeclaredSettingError: train reads the setting neurons, which its rule does not "
        "declare; it declares: name, number (log:"
    ) in result.stderr


def test_settings_that_nobody_reads_are_in_the_log(tmp_path):
    for body, said in (
        ("settings['name']", True),
        ("settings['name'], settings['number']", False),
        ("settings['name'], dict(settings)", False),
    ):
        _, log = run(
            tmp_path,
            f"""
            def main(*, data, network, settings):
                {body}
            """,
        )
        assert ("settings not read: number" in log) == said
        assert "is done" in log


def test_outputs_from_the_cache_say_nothing_about_settings(tmp_path):
    body = """
        os.environ["BURSTCAST_CACHE"] = "cache"
        snakemake.resources = {"cached": 1}

        def main(*, data, network, settings):
            settings["name"]
            write_json(network, {})
        """
    _, first = run(tmp_path, body)
    _, second = run(tmp_path, body)
    assert "outputs put into the cache" in first
    assert "settings not read: number" in first
    assert "outputs taken from the cache" in second
    assert "not read" not in second


@pytest.mark.parametrize(
    ("parameters", "complaint"),
    [
        ("*, network, settings", "main takes no argument data"),
        ("*, data, settings", "main takes no argument network"),
        ("*, data, network, other", "missing 1 required keyword-only argument: 'other'"),
    ],
)
def test_a_function_takes_all_files_of_its_rule_and_no_others(tmp_path, parameters, complaint):
    result, _ = run(
        tmp_path,
        f"""
        def main({parameters}):
            open("ran", "w")
        """,
    )
    assert result.returncode == 1
    assert "TypeError: " in result.stderr
    assert complaint in result.stderr
    assert not (tmp_path / "ran").exists()


def test_leftovers_of_killed_jobs_are_removed(tmp_path):
    leftover = tmp_path / "deep" / "er" / ".network.json.0123.partial"
    leftover.parent.mkdir(parents=True)
    leftover.write_text("half")
    run(tmp_path, "def main(*, data, network, settings): pass")
    assert not leftover.exists()


WAIT = """
def main(*, data, network, settings):
    with atomic(network) as partial:
        partial.write_text("half")
        open("ready", "w").close()
        time.sleep(30)
"""


def start_and_signal(tmp_path, number):
    def not_ignored():
        # as it is for what runs in the background of a shell, or under nohup
        if number != signal.SIGKILL:
            signal.signal(number, signal.SIG_DFL)

    process = subprocess.Popen(
        script(WAIT), cwd=tmp_path, stderr=subprocess.PIPE, text=True, preexec_fn=not_ignored
    )
    deadline = time.monotonic() + 20
    while not (tmp_path / "ready").exists():
        assert time.monotonic() < deadline
        time.sleep(0.02)
    process.send_signal(number)
    process.communicate(timeout=10)
    return process.returncode, sorted(os.listdir(tmp_path / "deep" / "er"))


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
def test_a_stopped_job_cleans_up(tmp_path, number):
    status, files = start_and_signal(tmp_path, number)
    assert status != 0
    assert files == []


def test_a_killed_job_leaves_nothing_that_looks_finished(tmp_path):
    status, files = start_and_signal(tmp_path, signal.SIGKILL)
    assert status == -signal.SIGKILL
    assert [name for name in files if not name.endswith(".partial")] == []


def test_importing_it_is_cheap():
    code = (
        "import sys, burstcast_workflow.harness.job\n"
        "slow = ('scipy', 'pandas', 'pydantic', 'yaml', 'llvmlite')\n"
        "print([name for name in slow if name in sys.modules])"
    )
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert result.stdout.strip() == "[]"


# -- the code that a job runs is the one that was planned ------------------------------------------


def test_code_that_was_edited_after_planning_is_not_run(tmp_path):
    result, _ = run(
        tmp_path,
        """
        script.write_text("import burstcast.durations; EDITED = 1")

        def main(*, data, network):
            write_json(network, {})
        """,
    )
    assert result.returncode == 1
    assert "UnlikeCodeError: train.py changed after the workflow was planned" in result.stderr
    assert not (tmp_path / "deep" / "er" / "network.json").exists()


def test_code_that_is_edited_while_a_job_runs_fails_it(tmp_path):
    body = """
        def main(*, data, network):
            write_json(network, {})
            script.write_text("import burstcast.durations%s")
        """
    result, _ = run(tmp_path, body % "; EDITED = 1")
    assert result.returncode == 1
    assert "train.py changed after the workflow was planned" in result.stderr
    # a comment is no edit
    result, _ = run(tmp_path, body % "  # a comment")
    assert result.returncode == 0


# -- the ends of logs ------------------------------------------------------------------------------


def write(path, text, age=0.0):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    os.utime(path, (time.time() - age, time.time() - age))
    return path


def test_nothing_failed(tmp_path):
    write(tmp_path / "logs" / "train" / "a.log", "starts\nINFO train (seed=1) is done: 1.00 s\n")
    assert failure_summary(tmp_path / "logs", tmp_path / "none", time.time() - 60) == ""


def test_ends_of_the_logs_of_failed_and_killed_jobs_in_the_order_of_time(tmp_path):
    lines = "".join(f"line {number}\n" for number in range(50))
    failed = write(tmp_path / "logs" / "b.log", lines + "ValueError: bad\n", age=20)
    killed = write(tmp_path / "logs" / "a.log", "", age=10)
    write(tmp_path / "logs" / "fine.log", "x is done: 1 s\n\n", age=5)
    of_slurm = write(tmp_path / "slurm" / "group" / "7.log", "exceeded memory limit\n")
    text = failure_summary(tmp_path / "logs", tmp_path / "slurm", time.time() - 60)
    assert text.index(str(failed)) < text.index(str(killed)) < text.index(str(of_slurm))
    assert "ValueError: bad" in text
    assert "(empty)" in text
    assert "exceeded memory limit" in text
    assert "line 49" in text
    assert "line 39\n" in text  # twelve lines in all
    assert "line 38\n" not in text
    assert "fine.log" not in text


def test_logs_of_earlier_runs_do_not_count(tmp_path):
    write(tmp_path / "logs" / "old.log", "ValueError: long ago\n", age=3600)
    assert failure_summary(tmp_path / "logs", tmp_path / "none", time.time() - 60) == ""


def test_many_failures_are_listed_by_name_only(tmp_path):
    for number in range(25):
        write(tmp_path / "logs" / f"{number}.log", f"reason {number}\n", age=100 - number)
    text = failure_summary(tmp_path / "logs", tmp_path / "none", time.time() - 1000)
    assert "reason 0" in text
    assert "15 more" in text
    assert "24.log" in text
    assert "reason 24" not in text


# -- what numbers depend on beside settings, code and inputs ---------------------------------------


def test_the_home_of_nobody_is_no_cache(monkeypatch, caplog):
    monkeypatch.setenv(environment.CACHE, "~nosuchuser/cache")
    assert environment.shared_results() is None
    assert "the cache ~nosuchuser/cache is not used: " in caplog.text


def test_a_cache_is_where_the_variable_says(monkeypatch, tmp_path):
    monkeypatch.delenv(environment.CACHE, raising=False)
    assert environment.shared_results() is None
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv(environment.CACHE, "~/cache")
    assert environment.shared_results().directory == tmp_path / "cache"
