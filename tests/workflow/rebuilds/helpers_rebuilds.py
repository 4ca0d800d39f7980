"""Working copies of the project in which the tests edit and run the workflow."""

import hashlib
import json
import os
import re
import shutil
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import yaml

from burstcast.base.discovery import imported_file

ROOT = Path(__file__).parents[3]
HERE = Path(__file__).parent
PARTS = ("Snakefile", "config.yaml", "profiles", "resources", "src", "workflow")
TINY = "workflow/presets/tiny.yaml"
RESULTS = "results/tiny"


@dataclass(frozen=True)
class Outcome:
    """How a run of Snakemake ended, and what it said."""

    status: int
    text: str

    @property
    def jobs(self) -> dict[str, int]:
        """Jobs of each rule in a dry run that is verbose, without the targets."""
        counted = re.search(r"^job +count\n[- ]+\n(.*?)^total ", self.text, re.M | re.S)
        if counted is None:
            assert "Nothing to be done" in self.text, self.text
            return {}
        counts = dict(line.split() for line in counted[1].splitlines())
        return {
            rule: int(count)
            for rule, count in counts.items()
            if rule not in ("all", "forecasters", "tables", "figures")
        }


class JobServer:
    """The process that runs scripts, and Snakemake itself, without importing libraries anew."""

    def __init__(self, directory: Path) -> None:
        self.address = str(directory / "server")

    @contextmanager
    def running(self) -> Iterator["JobServer"]:
        environment = {**os.environ, **THREADS}
        with subprocess.Popen(
            [sys.executable, str(HERE / "job_server.py"), self.address],
            stdout=subprocess.PIPE,
            env=environment,
        ) as process:
            assert process.stdout is not None
            assert process.stdout.readline() == b"ready\n"
            try:
                yield self
            finally:
                process.kill()

    def snakemake(self, directory: Path, *arguments: object) -> Outcome:
        """Run Snakemake with this project's code in any directory."""
        project, request = Project(directory, self), {"arguments": list(map(str, arguments))}
        return project._request(request, project.environment())


THREADS = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg"}
# as in the shell of a notebook
NOTEBOOK = {"MPLBACKEND": "module://matplotlib_inline.backend_inline"}


def loaded_script(name: str) -> ModuleType:
    """A script of the workflow, imported: its function does not run as a job."""
    return imported_file(ROOT / "workflow" / "scripts" / name)


_hashes: dict[Path, None] = {}  # files of plans so far


@dataclass(frozen=True)
class Project:
    """A working copy."""

    directory: Path
    server: JobServer | None = None  # what runs its jobs; or processes of their own, as for users
    preset: str = TINY  # the config that its runs lay over config.yaml
    workflow: tuple[str, ...] = ()  # option for a workflow that lies elsewhere

    @classmethod
    def create(
        cls,
        directory: Path,
        server: JobServer | None = None,
        preset: str = TINY,
        config: dict | None = None,
    ) -> "Project":
        """Copy the project's sources, with their time stamps; write the config of the preset.

        What Python has compiled comes along, and the hashes of code that an earlier plan found out:
        both take seconds, and hold until a source changes.
        """
        (directory / ".snakemake").mkdir(parents=True)
        for hashes in [path for path in _hashes if path.exists()][-1:]:
            shutil.copy(hashes, directory / ".snakemake")
        for part in PARTS:
            if (ROOT / part).is_dir():
                shutil.copytree(ROOT / part, directory / part)
            else:
                shutil.copy2(ROOT / part, directory / part)
        project = cls(directory, server, preset)
        if config is not None:
            project.configure(config)
        return project

    def configure(self, config: dict) -> None:
        """Write the config of its preset."""
        (self.directory / self.preset).write_text(yaml.safe_dump(config, sort_keys=False))

    def write_series(self, name: str, names: str, step: float, states: np.ndarray) -> None:
        """Write a table of states ``(samples, component)`` with times and a header."""
        rows = np.column_stack([step * np.arange(len(states)), states])
        header = {"header": f"time,{names}", "comments": "", "delimiter": ","}
        np.savetxt(self.directory / name, rows, fmt="%.17g", **header)

    def copy(self, directory: Path) -> "Project":
        """Copy everything with its time stamps: results and Snakemake's records, too."""
        shutil.rmtree(directory, ignore_errors=True)
        subprocess.run(["cp", "-a", self.directory, directory], check=True)
        return replace(self, directory=directory)

    def without_results(self, directory: Path) -> "Project":
        """Copy the sources only."""
        copy = self.copy(directory)
        shutil.rmtree(copy.directory / "results", ignore_errors=True)
        shutil.rmtree(copy.directory / ".snakemake", ignore_errors=True)
        shutil.rmtree(copy.directory / ".burstcast_cache", ignore_errors=True)
        return copy

    def environment(self) -> dict[str, str]:
        """Variables of its runs: its own code, or the repository's where it has none."""
        own = self.directory / "src"
        sources = str(own if own.exists() else ROOT / "src")
        without = ("BURSTCAST_CACHE", "BURSTCAST_RUN")
        variables = {name: value for name, value in os.environ.items() if name not in without}
        return {**variables, **THREADS, **NOTEBOOK, "PYTHONPATH": sources}

    def snakemake(self, *arguments: str, overlay: dict | None = None, **variables: str) -> Outcome:
        """Run Snakemake with the preset and what is laid over it."""
        options = self.options(*arguments, overlay=overlay)
        environment = {**self.environment(), **variables}
        if self.server is not None:
            return self._request({"arguments": options}, environment)
        result = subprocess.run(
            [sys.executable, "-m", "snakemake", *options],
            **{"cwd": self.directory, "env": environment, "timeout": 900},
            **{"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True},
            check=False,
        )
        return Outcome(result.returncode, result.stdout)

    def made(self, *targets: str, overlay: dict | None = None) -> Outcome:
        """Run Snakemake, which makes what it is asked for."""
        outcome = self.snakemake(*targets, overlay=overlay)
        assert outcome.status == 0, outcome.text[-3000:]
        return outcome

    def _request(self, request: dict, environment: dict[str, str]) -> Outcome:
        """Let the server run something, and wait for it."""
        assert self.server is not None
        read, write = os.pipe()
        with socket.socket(socket.AF_UNIX) as connection, open(os.devnull) as nothing:
            connection.connect(self.server.address)
            request = {**request, "directory": str(self.directory), "environment": environment}
            text = json.dumps(request).encode() + b"\n"
            socket.send_fds(connection, [text], [nothing.fileno(), write, write])
            os.close(write)
            with open(read, errors="replace") as stream:
                output = stream.read()
            status = connection.recv(1)
        _hashes[self.directory / ".snakemake" / "burstcast_code.json"] = None
        return Outcome(status[0] if status else 137, output)

    def options(self, *arguments: str, overlay: dict | None = None) -> list[str]:
        """Options of Snakemake; the overlay becomes a file."""
        configs = [self.preset]
        if overlay:
            (self.directory / "overlay.yaml").write_text(yaml.safe_dump(overlay))
            configs.append("overlay.yaml")
        cores = (
            [] if "-n" in arguments else ["--cores", os.environ.get("BURSTCAST_TEST_CORES", "2")]
        )
        return [*self.workflow, *arguments, *cores, "--configfile", *configs]

    def dry_run(self, *arguments: str, overlay: dict | None = None) -> dict[str, int]:
        """Jobs of each rule that would run."""
        return self.made("--verbose", "-n", *arguments, overlay=overlay).jobs

    def planned(self, overlay: dict | None = None) -> set[str]:
        """Jobs that would run, by the paths of their logs, or of new files, which have none."""
        lines = self.made("--summary", overlay=overlay).text.splitlines()
        names, *rows = [line.split("\t") for line in lines if line.count("\t") == 5]
        assert names[3:] == ["log-file(s)", "status", "plan"], names
        below_results = re.compile(r"results/\w+/(?:logs/)?")
        return {
            below_results.sub("", output if log == "-" else log.removesuffix(".log"), count=1)
            for output, _, _, log, _, plan in rows
            if plan == "update pending"
        }

    @property
    def results(self) -> Path:
        return self.directory / RESULTS

    def bits(self) -> dict[str, str]:
        """Digests of all results but logs, which have times in them."""
        made = digests(self.results)
        return {name: digest for name, digest in made.items() if not name.startswith("logs/")}

    def logs(self) -> dict[str, int]:
        """When each job's log was written: a job writes it when it runs."""
        logs = self.results / "logs"
        return {
            str(path.relative_to(logs)): path.stat().st_mtime_ns for path in logs.rglob("*.log")
        }

    @contextmanager
    def restored(self, *names: str) -> Iterator[None]:
        """Take back whatever happens to these files: edits, and that they are there at all."""
        paths = [self.directory / name for name in names]
        before = [path.read_text() if path.exists() else None for path in paths]
        try:
            yield
        finally:
            for path, text in zip(paths, before, strict=True):
                if text is None:
                    path.unlink(missing_ok=True)
                else:
                    path.write_text(text)

    @contextmanager
    def edited(self, name: str, old: str, new: str) -> Iterator[None]:
        """Replace the one place of a text in a file, and take it back."""
        with self.restored(name):
            self.edit(name, old, new)
            yield

    def edit(self, name: str, old: str, new: str) -> None:
        """Replace the one place of a text in a file."""
        path = self.directory / name
        text = path.read_text()
        assert text.count(old) == 1, f"{name} has {text.count(old)} of {old!r}"
        path.write_text(text.replace(old, new))


def digests(directory: Path) -> dict[str, str]:
    """Digests of all files of a directory but hidden ones, which hold times."""
    names = {path: str(path.relative_to(directory)) for path in sorted(directory.rglob("*"))}
    return {
        name: hashlib.sha256(path.read_bytes()).hexdigest()
        for path, name in names.items()
        if path.is_file() and not path.name.startswith(".")
    }


def jobs_since(before: dict[str, int], after: dict[str, int]) -> set[str]:
    """Logs of the jobs that ran between two looks at the logs."""
    return {name for name, time in after.items() if before.get(name) != time}


def rules_of(logs: set[str]) -> set[str]:
    """Rules that logs belong to: their directories, or their names."""
    return {name.split("/")[0].removesuffix(".log") for name in logs}


@contextmanager
def mounted(directory: Path, size: str) -> Iterator[None]:
    """A disk of a given size in the place of a directory."""
    directory.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", f"size={size}", "none", str(directory)]
    if subprocess.run(command, capture_output=True, check=False).returncode:
        pytest.skip("a disk of a given size needs the right to mount one")
    try:
        yield
    finally:
        subprocess.run(["umount", "-l", directory], check=True)
