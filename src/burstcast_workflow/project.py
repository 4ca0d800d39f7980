"""Places of the workflow's own files: Snakefile, rules, scripts, presets, published values.

In a working copy they are beside ``src``. A wheel has them inside this package, where `setup.py`
puts them, so that an installed burstcast runs as it is.
"""

import subprocess
from pathlib import Path

PACKAGES = ("burstcast", "burstcast_workflow")
"""Packages whose code is fingerprinted by definition, also in a shared ``site-packages``."""

UNTRACKED = (
    "burstcast_workflow.harness.logs.",  # what logs tell
    "burstcast_workflow.harness.running.",  # logs, caches and claims around a job
    "burstcast_workflow.project.",  # where files lie
    "burstcast_workflow.tracking.",  # hashes, digests, the cache, ownership
)
"""Packages and modules, each with a point, that are in no fingerprint: they change no result."""

_PACKAGE = Path(__file__).resolve().parent
# beside the workflow's files in a wheel: what they were built from
_REVISION = "revision.txt"
_INSTALLED = "project"


def project_root() -> Path:
    """Directory with the workflow's Snakefile."""
    installed = _PACKAGE / _INSTALLED
    return installed if installed.is_dir() else _PACKAGE.parents[1]


def snakefile() -> str:
    """Path of the workflow's Snakefile, for a workflow that takes it as a module."""
    return str(project_root() / "Snakefile")


def packages_of(project: Path) -> Path:
    """Directory of the packages that belong to the workflow's files in a directory."""
    beside = project / "src"
    return beside if beside.is_dir() else project.parents[1]


def source_revision() -> str:
    """Git revision of the sources, with ``-dirty`` where files differ from it; or "unknown".

    A wheel knows the one that it was built from.
    """
    root = project_root()
    noted = root / _REVISION
    if noted.exists():
        return noted.read_text(encoding="utf-8").strip()
    return git_revision(root)


def git_revision(root: Path) -> str:
    """Revision of a working copy, with ``-dirty`` where files that git knows differ from it."""

    def git(*arguments: str) -> str:
        command = ["git", "-C", str(root), *arguments]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()

    try:
        if Path(git("rev-parse", "--show-toplevel")).resolve() != root.resolve():
            return "unknown"  # a directory inside another repository
        commit = git("rev-parse", "HEAD")
        changed = git("status", "--porcelain", "--untracked-files=no", "--", ".")
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return f"{commit}-dirty" if changed else commit
