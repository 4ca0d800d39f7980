"""An interruption that meets a job while it imports leaves no traceback."""

import io
import signal
import subprocess
import sys

import pytest
from snakemake.script import PythonScript

from burstcast_workflow import snakemake_patches
from burstcast_workflow.snakemake_patches import FIRST_LINE, interrupt_quietly

WAITS = "import sys, time; print('ready', flush=True); time.sleep(60)"


def interrupted(first_line, patience=20.0, disposition=signal.SIG_DFL):
    """Status of a Python process that SIGINT meets, None if it goes on; and what it says.

    What runs in a shell's background ignores SIGINT, and hands that on: so the process is told.
    """
    process = subprocess.Popen(
        [sys.executable, "-c", first_line + WAITS],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, disposition),
    )
    assert process.stdout.readline() == "ready\n"
    process.send_signal(signal.SIGINT)
    try:
        status = process.wait(patience)
    except subprocess.TimeoutExpired:
        status = None
    process.kill()
    return status, process.communicate()[1]


def test_a_process_ends_at_once_and_says_nothing():
    assert interrupted(FIRST_LINE.decode()) == (-signal.SIGINT, "")
    assert "KeyboardInterrupt" in interrupted("")[1]


def test_an_interruption_that_is_ignored_stays_so():
    assert interrupted(FIRST_LINE.decode(), 0.5, signal.SIG_IGN) == (None, "")


@pytest.fixture
def snakemakes_own(monkeypatch):
    monkeypatch.setattr(PythonScript, "write_script", snakemake_patches._write_script)


@pytest.mark.usefixtures("snakemakes_own")
def test_scripts_of_snakemake_begin_with_it():
    interrupt_quietly()
    script = PythonScript.__new__(PythonScript)
    script.source = "print(1)"
    file = io.BytesIO()
    script.write_script("preamble\n", file)
    assert file.getvalue() == FIRST_LINE + b"preamble\nprint(1)"
