"""Ctrl-C: a job that it meets while it still imports ends without a traceback.

From then on `burstcast_workflow.harness.job.run_job` sees to it.
"""

from typing import Any, BinaryIO

import snakemake.api  # noqa: F401 - other modules of Snakemake cannot be imported before it
from snakemake.script import PythonScript

FIRST_LINE = (
    b"import signal; signal.getsignal(2) is signal.SIG_IGN or signal.signal(2, signal.SIG_DFL)\n"
)
"""What scripts begin with: SIGINT, 2, ends the process at once, unless it is ignored (nohup)."""

_write_script = PythonScript.write_script


def interrupt_quietly() -> None:
    """Have Snakemake put `FIRST_LINE` before the scripts that it runs from now on."""

    def write_script(self: Any, preamble: str, fd: BinaryIO) -> None:
        fd.write(FIRST_LINE)
        _write_script(self, preamble, fd)

    PythonScript.write_script = write_script
