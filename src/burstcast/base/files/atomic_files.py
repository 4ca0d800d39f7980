"""Files that are written completely or not at all.

A file is written under a temporary name beside its final one, flushed to the disk and renamed, so
that a process that dies leaves nothing that looks finished.
"""

import errno
import os
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

PARTIAL_SUFFIX = ".partial"
"""End of the names of temporary files."""

_LITTLE_SPACE = 2**16


@contextmanager
def atomic(path: str | Path, check: Callable[[], None] | None = None) -> Iterator[Path]:
    """Yield a temporary path that is renamed to ``path``, or removed after an exception.

    ``check``: Called when the temporary file is complete, before it is renamed; it may raise.
    """
    path = Path(path)
    # unique: another process may still be writing the same file
    partial = path.with_name(f".{path.name}.{os.urandom(6).hex()}{PARTIAL_SUFFIX}")
    try:
        yield partial
        _flush_to_disk(partial)
        if check is not None:
            check()
        os.replace(partial, path)
    except BaseException as error:
        full = isinstance(error, OSError | RuntimeError) and _disk_is_full(path.parent, error)
        partial.unlink(missing_ok=True)
        if full:
            text = "the disk is full: make room, and run again"
            raise OSError(errno.ENOSPC, text, str(path)) from error
        raise
    _flush_to_disk(path.parent)


def remove_partial(path: str | Path) -> None:
    """Remove temporary files of killed writers of ``path``; a writer that is alive then fails."""
    path = Path(path)
    for other in [*path.parent.iterdir()]:
        # x must not take the partial file of x.csv
        if re.fullmatch(rf"\.{re.escape(path.name)}\.[0-9a-f]+{PARTIAL_SUFFIX}", other.name):
            other.unlink(missing_ok=True)


def _disk_is_full(directory: Path, error: BaseException) -> bool:
    if getattr(error, "errno", None) in (errno.ENOSPC, errno.EDQUOT):
        return True
    state = os.statvfs(directory)
    return state.f_bavail * state.f_frsize < _LITTLE_SPACE


def _flush_to_disk(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
