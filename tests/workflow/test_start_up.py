"""A script loads only what it needs: starting up is most of what many jobs do."""

import ast
import subprocess
import sys
from dataclasses import replace
from fnmatch import fnmatch
from pathlib import Path

import pytest

from burstcast.figures.registry import available_figures
from burstcast_workflow.project import code_of
from snaketrust.fingerprint import Sources

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "src"
SCRIPTS = sorted((ROOT / "workflow" / "scripts").glob("*/*.py"))
# What a job runs: a script, or the module of a figure.
STARTED = [
    *SCRIPTS,
    *(SOURCE / "burstcast" / "figures" / f"{name}.py" for name in available_figures()),
]

# Libraries that take long to load, and the scripts and figures that cannot do without them.
NEEDED_BY = {
    "llvmlite": [],
    "skopt": ["forecasters/search.py"],
    "sklearn": [],  # by scikit-optimize only
    "skimage": ["figures/vorticity_isosurfaces.py"],
    "matplotlib": ["figures/*.py"],
    "pydantic": [],
    "snakemake": [],
    "yaml": [],
}
# Modules of ours that load much, and those who have nothing to do with networks.
NETWORK = "burstcast.esn.reservoir"
WITHOUT_NETWORKS = [
    "tables/*.py",
    "data/*.py",
    "control/*.py",
]


def libraries(path: Path) -> set[str]:
    """Packages that the imports at the top of a file name."""
    found = set()
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found.add(node.module.partition(".")[0])
    return found


def modules(script: Path) -> list[str]:
    """Modules of ours that a script reaches through imports, at the top or in a function."""
    sources = Sources(replace(code_of(ROOT), scripts=script.parent))
    names = [entry.partition("@")[0] for entry in sources.fingerprint(script.name)]
    return [name for name in names if name != script.name]


def place(module: str) -> Path:
    path = SOURCE.joinpath(*module.split("."))
    return path / "__init__.py" if path.is_dir() else path.with_name(path.name + ".py")


def loaded(script: Path) -> set[str]:
    """Packages that a script and our modules load."""
    return libraries(script).union(*(libraries(place(module)) for module in modules(script)))


def allowed(script: Path, patterns: list[str]) -> bool:
    return any(fnmatch(f"{script.parent.name}/{script.name}", pattern) for pattern in patterns)


@pytest.mark.parametrize("script", STARTED, ids=lambda path: path.stem)
def test_a_script_loads_no_library_that_it_does_not_need(script):
    needless = [
        library
        for library in loaded(script)
        if library in NEEDED_BY and not allowed(script, NEEDED_BY[library])
    ]
    assert not needless


@pytest.mark.parametrize(
    "script",
    [script for script in SCRIPTS if allowed(script, WITHOUT_NETWORKS)],
    ids=lambda path: path.stem,
)
def test_a_script_without_networks_does_not_load_them(script):
    assert NETWORK not in modules(script)


@pytest.mark.parametrize("library", ["skopt", "skimage", "matplotlib"])
def test_the_libraries_are_found_where_they_are_needed(library):
    users = [script for script in STARTED if allowed(script, NEEDED_BY[library])]
    assert users
    assert all(library in loaded(script) for script in users)


def test_the_job_with_most_instances_starts_without_what_it_does_not_compute_with():
    script = ROOT / "workflow" / "scripts" / "evaluation" / "forecast.py"
    imports = [
        ast.unparse(node)
        for node in ast.parse(script.read_text(encoding="utf-8")).body
        if isinstance(node, ast.Import | ast.ImportFrom)
    ]
    code = "\n".join([*imports, "import sys", "print(*sys.modules)"])
    output = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    heavy = {
        "llvmlite",
        "pandas",
        "matplotlib",
        "skopt",
        "sklearn",
        "scipy.stats",
        "scipy.optimize",
    }
    assert not heavy & set(output.stdout.split())
