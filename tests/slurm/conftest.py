"""A Slurm of one machine for all tests of this directory, taken down at the end."""

import tempfile
from pathlib import Path

import pytest
from one_machine_slurm import OneMachineSlurm, install, installed, reason_not_to_run


@pytest.fixture(scope="session")
def slurm():
    pytest.importorskip(
        "snakemake_executor_plugin_slurm", reason="needs snakemake-executor-plugin-slurm"
    )
    reason = reason_not_to_run() or (None if installed() else install())
    if reason:
        pytest.skip(reason)
    with tempfile.TemporaryDirectory(prefix="slurm-") as directory:
        one_machine = OneMachineSlurm(Path(directory), cores=2, memory_mib=8000)
        try:
            one_machine.start()
            yield one_machine
        finally:
            one_machine.stop()
