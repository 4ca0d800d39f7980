"""Workflows of other projects, run where burstcast cannot be imported."""

import os
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path

import snaketrust

HERE = Path(__file__).parent
BLOCK = """
import sys
for name in ("burstcast", "burstcast_workflow"):
    sys.modules[name] = None
"""
OPTIONS = ("--cores", "1", "--rerun-triggers", "mtime", "params", "input", "software-env")


class Toy:
    """A copy of the toy, or another workflow, and what Snakemake does in it."""

    def __init__(self, directory, files=None):
        self.directory = directory / "toy"
        if files is None:
            shutil.copytree(HERE / "toy", self.directory)
        for name, text in (files or {}).items():
            path = self.directory / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        place = directory / "path"
        place.mkdir()
        (place / "sitecustomize.py").write_text(BLOCK)
        (place / "snaketrust").symlink_to(Path(snaketrust.__path__[0]))
        path = f"{place}{os.pathsep}{self.directory / 'lib'}"
        self.environment = {**os.environ, "PYTHONPATH": path, "SNAKETRUST_RUN": ""}

    def run(self, *arguments, fails=False, **variables):
        """Rules of the jobs that ran, with their numbers; what is said, where the run fails."""
        done = subprocess.run(
            [sys.executable, "-m", "snakemake", *OPTIONS, *arguments],
            cwd=self.directory,
            env={**self.environment, **variables},
            capture_output=True,
            text=True,
        )
        said = done.stdout + done.stderr
        assert (done.returncode != 0) == fails, said
        if fails:
            return said
        return Counter(
            line.split()[1].rstrip(":")
            for line in said.splitlines()
            if line.startswith(("rule ", "localrule ")) and line.endswith(":") and "," not in line
        )

    def edit(self, name, old, new):
        path = self.directory / name
        text = path.read_text()
        assert old in text
        path.write_text(text.replace(old, new))

    def total(self):
        return int((self.directory / "results" / "total.txt").read_text())
