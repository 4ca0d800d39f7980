"""Digests of files, and files that are written completely or not at all."""

import hashlib
import os
import re
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

PARTIAL_SUFFIX = ".partial"
"""End of the names of temporary files."""


def digest(path: str | Path) -> str:
    """SHA-256 of a file's content, or of the names and digests of all files in a directory."""
    if os.path.isdir(path):
        inside = sorted((str(one.relative_to(path)), digest(one)) for one in _inside(path))
        return hashlib.sha256(repr(inside).encode()).hexdigest()
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def stamp(path: str) -> list[int]:
    """State of a file: size, times of the last change of content and of status, inode.

    Of a directory: the size of all files in it, and the latest times.
    """
    state = os.stat(path)
    states = [state, *map(os.stat, _inside(path))] if stat.S_ISDIR(state.st_mode) else [state]
    times = (max(one.st_mtime_ns for one in states), max(one.st_ctime_ns for one in states))
    return [sum(one.st_size for one in states), *times, state.st_ino]


def _inside(directory: str | Path) -> list[Path]:
    return [path for path in Path(directory).rglob("*") if path.is_file()]


@contextmanager
def replaced(path: Path, check: Callable[[], None] | None = None) -> Iterator[Path]:
    """Yield a temporary path to write to, which becomes ``path`` unless an exception is raised.

    ``check`` is called when the temporary file is complete; it may raise.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.name}.{os.urandom(6).hex()}{PARTIAL_SUFFIX}")
    try:
        yield partial
        if check is not None:
            check()
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)


def remove_partial(path: Path) -> None:
    """Remove the temporary files that killed writers of ``path`` have left behind.

    A writer that is still alive loses its temporary file and fails: the caller takes its place.
    """
    for other in [*path.parent.iterdir()]:
        # x must not take the partial file of x.csv
        if re.fullmatch(rf"\.{re.escape(path.name)}\.[0-9a-f]+{PARTIAL_SUFFIX}", other.name):
            other.unlink(missing_ok=True)


def flush(path: Path) -> None:
    """Wait until a file has reached the disk."""
    with path.open("rb") as file:
        os.fsync(file.fileno())
