"""The library needs nothing of the workflow, and no drawing but for the figures."""

import json
import os
import pkgutil
import subprocess
import sys
from pathlib import Path

import burstcast

SOURCE = Path(burstcast.__file__).parents[1]
BLOCKED = ("snakemake", "yaml", "netCDF4", "pydantic", "matplotlib", "skimage")

# A module that is None in sys.modules cannot be imported. What the library depends on may itself
# use one of them, as scikit-optimize does YAML.
IMPORT_ALL = """
import importlib, json, sys
import llvmlite, pandas, skopt, skopt.learning
names, blocked = json.loads(sys.argv[1])
sys.modules.update(dict.fromkeys([*blocked, "burstcast_workflow"]))
for name in names:
    importlib.import_module(name)
"""


def modules() -> list[str]:
    """All modules of the library but those of the figures."""
    found = pkgutil.walk_packages(burstcast.__path__, "burstcast.")
    return [module.name for module in found if not module.name.startswith("burstcast.figures")]


def test_the_library_stands_alone() -> None:
    names = modules()
    assert len(names) > 50
    result = subprocess.run(
        [sys.executable, "-c", IMPORT_ALL, json.dumps([names, BLOCKED])],
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": str(SOURCE)},
        check=False,
    )
    assert result.returncode == 0, result.stderr
