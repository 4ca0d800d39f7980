"""The library needs what ``pip install burstcast`` brings, and nothing of the workflow."""

import ast
import json
import os
import pkgutil
import re
import shutil
import subprocess
import sys
from importlib.metadata import distribution
from pathlib import Path

import pytest

import burstcast

SOURCE = Path(burstcast.__file__).parents[1]
ROOT = SOURCE.parent
OTHERS = ["snakemake", "pydantic", "matplotlib", "skimage", "burstcast_workflow", "snaketrust"]


def test_dataclasses_are_frozen():
    """What has been checked when it was made stays so, and can be a key."""
    thawed = [
        f"{path.stem}.{node.name}"
        for path in (SOURCE / "burstcast").rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ClassDef)
        for decorator in map(ast.unparse, node.decorator_list)
        if decorator.startswith("dataclass") and "frozen=True" not in decorator
    ]
    assert thawed == []


IMPORT_ALL = """
import importlib, importlib.util, json, sys
names, others = json.loads(sys.argv[1])
assert not [name for name in others if importlib.util.find_spec(name)]
for name in names:
    importlib.import_module(name)
"""
SAVE_AND_LOAD = """
import numpy as np
import burstcast

time = np.arange(400) * 0.1
phases = np.random.default_rng(1).uniform(0, 6, (6, 1))
series = np.stack([np.sin(time + phases), np.cos(time + phases)], axis=-1)
forecaster = burstcast.EventForecaster(
    kind="analogues",
    observable=0,
    event_threshold=0.9,
    prediction_times=(1,),
    lyapunov_time=2.0,
    sampling_interval=0.1,
)
forecaster.fit(series).save("saved.nc")
found = burstcast.EventForecaster.load("saved.nc")
assert np.array_equal(found.predict_proba(series), forecaster.predict_proba(series))
"""


def required(name: str, found: dict[str, object]) -> None:
    """Collect a distribution and all that it requires, by name, without extras."""
    if name not in found:
        found[name] = distribution(name)
        for requirement in found[name].requires or []:
            if ";" not in requirement:
                required(re.match(r"[\w.-]+", requirement).group().lower(), found)


@pytest.fixture(scope="module")
def environment(tmp_path_factory) -> dict[str, str]:
    """Environment of a Python that finds the library and what it requires, and nothing else."""
    directory = tmp_path_factory.mktemp("site")
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    (listed,) = re.findall(r"^dependencies = \[(.*?)^\]", project, re.MULTILINE | re.DOTALL)
    found: dict[str, object] = {}
    for name in re.findall(r'"([\w-]+)>=', listed):
        required(name.lower(), found)
    (directory / "burstcast").symlink_to(SOURCE / "burstcast")
    for one in found.values():
        for part in {file.parts[0] for file in one.files} - {"..", "__pycache__"}:
            (directory / part).symlink_to(one.locate_file(part))
    return {**os.environ, "PYTHONPATH": str(directory)}


def run(environment, directory, *arguments: str) -> None:
    command = [sys.executable, "-S", "-c", *arguments]
    result = subprocess.run(
        command, capture_output=True, text=True, env=environment, cwd=directory, check=False
    )
    assert result.returncode == 0, result.stderr


def test_the_library_stands_alone(environment, tmp_path):
    found = pkgutil.walk_packages(burstcast.__path__, "burstcast.")
    names = [one.name for one in found if not one.name.startswith("burstcast.figures")]
    assert len(names) > 50
    run(environment, tmp_path, IMPORT_ALL, json.dumps([names, OTHERS]))


def test_forecasters_are_saved_and_loaded_by_the_library_alone(environment, tmp_path):
    run(environment, tmp_path, SAVE_AND_LOAD)


def test_no_function_of_the_library_imports_the_workflow():
    imported = set()
    for path in (SOURCE / "burstcast").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                imported |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                imported.add(node.module.partition(".")[0])
    assert "numpy" in imported
    assert not imported & {"burstcast_workflow", "snaketrust", "snakemake", "pydantic", "yaml"}


@pytest.mark.long
def test_a_plain_installation_saves_and_loads(tmp_path):
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True)
    for name in listed.stdout.splitlines():  # building writes into the sources
        if (ROOT / name).exists():
            (tmp_path / "source" / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, tmp_path / "source" / name)
    python = tmp_path / "venv" / "bin" / "python"
    subprocess.run([sys.executable, "-m", "venv", tmp_path / "venv"], check=True)
    install = [python, "-m", "pip", "install", "-q", "--disable-pip-version-check"]
    subprocess.run(
        [*install, "-c", ROOT / "requirements.lock", "./source"], cwd=tmp_path, check=True
    )
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    subprocess.run([python, "-c", SAVE_AND_LOAD], check=True, env=environment, cwd=tmp_path)
