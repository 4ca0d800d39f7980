"""The package alone, with several releases of Snakemake, each in an environment of its own."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import snaketrust
from snaketrust.hooks import TESTED

HERE = Path(__file__).parent
NEEDED = ("pytest", "snakemake-interface-report-plugins<2")


@pytest.mark.long
@pytest.mark.parametrize("release", TESTED)
def test_a_release_of_snakemake(tmp_path, release):
    place = Path(os.environ.get("SNAKETRUST_RELEASES", tmp_path)) / release
    python = str(place / "bin" / "python")
    if not place.exists():
        subprocess.run([sys.executable, "-m", "venv", str(place)], check=True)
        install = [python, "-m", "pip", "install", "--quiet", f"snakemake=={release}", *NEEDED]
        subprocess.run(install, check=True)
    # the package and its tests, without anything of burstcast
    shutil.copytree(Path(snaketrust.__path__[0]), tmp_path / "path" / "snaketrust")
    shutil.copytree(HERE, tmp_path / "tests")
    tests = [str(tmp_path / "tests" / f"test_{name}.py") for name in ("toy", "hooks")]
    path = {**os.environ, "PYTHONPATH": str(tmp_path / "path")}
    command = [python, "-m", "pytest", "-q", "-c", os.devnull, "--rootdir", str(tmp_path), *tests]
    done = subprocess.run(command, env=path, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-5000:]
