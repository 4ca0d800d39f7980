"""The package imports nothing of this project, and no job loads Snakemake through it."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import snaketrust

MODULES = sorted(Path(snaketrust.__path__[0]).glob("*.py"))
OF_SNAKEMAKE = {"checks", "hooks", "plan"}


def imported(path: Path) -> set[str]:
    nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
    names = [
        name
        for node in nodes
        if isinstance(node, ast.Import | ast.ImportFrom)
        for name in (
            [node.module]
            if isinstance(node, ast.ImportFrom)
            else [alias.name for alias in node.names]
        )
    ]
    return {str(name).partition(".")[0] for name in names}


@pytest.mark.parametrize("path", MODULES, ids=lambda path: path.stem)
def test_it_imports_the_standard_library_and_snakemake(path):
    others = imported(path) - {*sys.stdlib_module_names, "snaketrust"}
    assert others == ({"snakemake"} if path.stem in OF_SNAKEMAKE else set())


def test_a_job_loads_little():
    code = "import sys; before = {*sys.modules}; import snaketrust.job; print(*sys.modules)"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"snakemake", "numpy", "burstcast"} & {*said.stdout.split()}
