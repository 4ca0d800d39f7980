import json
import os
import signal
import subprocess
import sys
import textwrap
import time

import pytest

HEADER = """
import os, sys, time
import numpy as np
from types import SimpleNamespace
from burstcast_workflow.harness.job import run_job
from burstcast_workflow.harness.storage import atomic, write_json

class Files(list):
    def __init__(self, **names):
        super().__init__(names.values())
        self.__dict__.update(names)

snakemake = SimpleNamespace(
    rule="train", log=["logs/train.log"], wildcards={"case": "Re400", "seed": "3"},
    input=Files(data="data.nc"), output=Files(network="deep/er/network.json"),
    params=SimpleNamespace(settings={"seed": 3.0, "name": "Re400"}, code=["x@1"]),
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
        def main(inputs, outputs, settings, provenance):
            print("from print")
            os.system("echo from a child")
            os.write(2, b"from compiled code")
            np.log(np.zeros(1))
            assert inputs.data == "data.nc"
            write_json(outputs.network, {"settings": settings, "provenance": provenance})
        """,
    )
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
    record = json.loads((tmp_path / "deep" / "er" / "network.json").read_text())
    assert record["settings"] == {"name": "Re400", "seed": 3}
    assert 'train (case=Re400, seed=3) starts with settings {"name": "Re400", "seed": 3}' in log
    for text in ("from print", "from a child", "from compiled code", "RuntimeWarning: divide"):
        assert text in log
    assert "is done: 0." in log
    assert "MiB" in log


def test_provenance_has_versions_and_nothing_of_time_machine_or_path(tmp_path):
    records = []
    for name in ("first", "second"):
        (tmp_path / name).mkdir()
        run(
            tmp_path / name,
            """
            def main(inputs, outputs, settings, provenance):
                write_json(outputs.network, provenance)
            """,
        )
        records.append((tmp_path / name / "deep" / "er" / "network.json").read_bytes())
    assert records[0] == records[1]
    record = json.loads(records[0])
    libraries = {"numpy", "scipy", "numba", "scikit-optimize"}
    assert set(record) == {"source", "rule", "identity", "settings", "python"} | libraries
    assert record["source"].startswith("burstcast ")
    assert record["identity"] == '{"case": "Re400", "rule": "train", "seed": 3}'
    assert record["settings"] == '{"name": "Re400", "seed": 3}'
    assert all(isinstance(value, str) for value in record.values())


def test_failure_is_one_line_and_a_traceback_in_the_log(tmp_path):
    result, log = run(
        tmp_path,
        """
        def main(inputs, outputs, settings, provenance):
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
        def main(inputs, outputs, settings, provenance):
            raise AssertionError("must not run")
        """,
    )
    assert result.returncode == 1
    assert "TypeError: params.settings.neurons is" in result.stderr


def test_leftovers_of_killed_jobs_are_removed(tmp_path):
    leftover = tmp_path / "deep" / "er" / ".network.json.0123.partial"
    leftover.parent.mkdir(parents=True)
    leftover.write_text("half")
    run(tmp_path, "def main(inputs, outputs, settings, provenance): pass")
    assert not leftover.exists()


WAIT = """
def main(inputs, outputs, settings, provenance):
    with atomic(outputs.network) as partial:
        partial.write_text("half")
        open("ready", "w").close()
        time.sleep(30)
"""


def start_and_signal(tmp_path, number):
    process = subprocess.Popen(script(WAIT), cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 20
    while not (tmp_path / "ready").exists():
        assert time.monotonic() < deadline
        time.sleep(0.02)
    process.send_signal(number)
    process.communicate(timeout=10)
    return process.returncode, sorted(os.listdir(tmp_path / "deep" / "er"))


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
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
        "print([n for n in ('scipy', 'pandas', 'pydantic', 'yaml', 'numba') if n in sys.modules])"
    )
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert result.stdout.strip() == "[]"
