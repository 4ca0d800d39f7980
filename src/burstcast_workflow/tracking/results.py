"""Results of jobs: what their job wrote, and whether they still are that.

Beside each result lies ``.<name>.sha256`` with the digest of what its job wrote, and the size, time
and inode that the file had then. A file is only read again where one of these three differs.
"""

import hashlib
import os
import secrets
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

_SUFFIX = ".sha256"


class DamagedResultError(ValueError):
    """A result is not what its job wrote."""


def digest(path: str | Path) -> str:
    """SHA-256 of a file's content; of a directory, a Zarr store, also of its files' names."""
    if (directory := Path(path)).is_dir():
        files = sorted(file for file in directory.rglob("*") if file.is_file())
        named = "".join(f"{digest(file)} {file.relative_to(directory)}\n" for file in files)
        return hashlib.sha256(named.encode()).hexdigest()
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def note(path: str | Path, content: str) -> None:
    """Write the digest of a result's content beside it."""
    sidecar = _sidecar(path)
    partial = sidecar.with_suffix(f".{secrets.token_hex(4)}")
    partial.write_text(" ".join([content, *_stamp(path)]))
    os.replace(partial, sidecar)


def forget(path: str | Path) -> None:
    """Remove the digest of a result that is about to be made again, perhaps not to its end."""
    _sidecar(path).unlink(missing_ok=True)


def checked(path: str) -> str:
    """Digest of an input; `DamagedResultError` if it is a result, and not what its job wrote."""
    try:
        content, *stamp = _sidecar(path).read_text().split()
    except (OSError, ValueError):
        return digest(path)  # no result of a job: a file of the user, or one of a storage
    if stamp != _stamp(path):
        if digest(path) != content:
            raise DamagedResultError(
                f"{path} is not what its job wrote: it was edited, exchanged or cut off since. "
                f"Delete it, and run again"
            )
        with suppress(OSError):  # the results may be read-only
            note(path, content)
    return content


def damaged(directory: str | Path) -> list[str]:
    """Results in a directory that are not what their jobs wrote; deleted ones are none of them."""
    files = []
    for sidecar in Path(directory).rglob(f".*{_SUFFIX}"):
        path = sidecar.with_name(sidecar.name.removeprefix(".").removesuffix(_SUFFIX))
        try:
            checked(str(path))
        except FileNotFoundError:
            sidecar.unlink(missing_ok=True)
        except DamagedResultError:
            files.append(str(path))
    return sorted(files)


def date_after(outputs: Iterable[str], inputs: Iterable[str]) -> None:
    """Date outputs no earlier than inputs, which another machine's clock may have dated later."""
    newest = max((os.stat(path).st_mtime_ns for path in inputs), default=0)
    for path in outputs:
        if os.stat(path).st_mtime_ns < newest:
            os.utime(path, ns=(newest, newest))


def _sidecar(path: str | Path) -> Path:
    path = Path(path)
    return path.with_name(f".{path.name}{_SUFFIX}")


def _stamp(path: str | Path) -> list[str]:
    state = os.stat(path)
    return [str(state.st_size), str(state.st_mtime_ns), str(state.st_ino)]
