"""The package imports nothing of this project, and runs with several releases of Snakemake."""

import ast
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import snaketrust
from snaketrust.hooks import TESTED

MODULES = sorted(Path(snaketrust.__path__[0]).glob("*.py"))
OF_SNAKEMAKE = {"checks", "hooks", "plan"}


def imported(path):
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom):
            names.add(node.module)
        elif isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
    return {str(name).partition(".")[0] for name in names}


@pytest.mark.parametrize("path", MODULES, ids=lambda path: path.stem)
def test_it_imports_the_standard_library_and_snakemake(path):
    others = imported(path) - {*sys.stdlib_module_names, "snaketrust"}
    assert others == ({"snakemake"} if path.stem in OF_SNAKEMAKE else set())


def test_a_job_loads_little():
    code = "import sys; before = {*sys.modules}; import snaketrust.job; print(*sys.modules)"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"snakemake", "numpy", "burstcast"} & {*said.stdout.split()}


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
