"""Results shared between campaigns, result directories and working copies.

The cache is a directory, named by the environment variable ``BURSTCAST_CACHE``; without it there is
none. An entry holds the outputs of one job under a key made of everything that they depend on: the
rule, its settings, the fingerprints of its code, the versions of the libraries that change results,
and the content of its inputs. A job whose key is there takes its outputs from the cache instead of
computing them; docs/selective_rebuilds.md says what is sound about it and what is not looked at.

Entries are written under a temporary name and renamed, and every file is verified by its checksum
each time it is used. Trouble with the cache itself is logged and otherwise ignored: the job then
computes. Outputs are copied, not linked: a link would share its time stamp, which Snakemake acts
on, with other campaigns.

`burstcast_workflow.cache_command` is what a person sees of it.
"""

import hashlib
import json
import logging
import os
import platform
import re
import shutil
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_info

from burstcast_workflow.canonical import canonical_json
from burstcast_workflow.harness.records import digest
from burstcast_workflow.harness.storage import atomic, write_json

logger = logging.getLogger(__name__)

VARIABLE = "BURSTCAST_CACHE"
"""Environment variable that names the cache's directory. It is no setting: it changes no result."""

LIBRARIES = ("numpy", "scipy", "llvmlite", "scikit-learn", "scikit-optimize")
"""Libraries another version of which may give other numbers."""

_FORMAT = 4
_RECORD = "record.json"
# names that entries have, and what is built or removed: nothing else there is the cache's
_KEY = re.compile(r"[0-9a-f]{64}")
_BUILDING = re.compile(rf"{_KEY.pattern}\.[0-9a-f]{{12}}")
_BLOCK = 2**20
_ABANDONED_SECONDS = 24 * 3600.0


class DamagedEntryError(ValueError):
    """An entry is not what was stored."""


def location() -> Path | None:
    """Directory of the cache; None where there is none."""
    directory = os.environ.get(VARIABLE, "")
    try:
        return Path(directory).expanduser() if directory else None
    except RuntimeError as error:
        logger.warning("the cache %s is not used: %s", directory, error)
        return None


def entry_key(
    identity: Mapping[str, Any],
    settings: Mapping[str, Any],
    code: Sequence[str],
    inputs: Mapping[str, Sequence[str]],
    outputs: Sequence[str],
) -> str:
    """Key of a job's entry: a hash of everything that its outputs depend on.

    Parameters
    ----------
    identity
        Rule and wildcards: outputs say them, so that those of another job are not its own.
    settings
        All settings that its script reads.
    code
        Fingerprints of its code.
    inputs
        Digests of its inputs, by name.
    outputs
        Names of its outputs.
    """
    import numpy  # most jobs that ask for a key have it loaded; the others start without it

    material = {
        "format": _FORMAT,
        "identity": identity,
        "settings": settings,
        "code": sorted(code),
        "libraries": {name: library_version(name) for name in LIBRARIES},
        "python": ".".join(platform.python_version_tuple()[:2]),
        "machine": platform.machine(),
        "instructions": numpy.show_config(mode="dicts").get("SIMD Extensions"),
        "blas": blas_kernels(),
        "inputs": inputs,
        "outputs": sorted(outputs),
    }
    return hashlib.sha256(canonical_json(material, "key").encode()).hexdigest()


@cache
def library_version(library: str) -> str:
    """Version of a library; not every platform has all of them."""
    try:
        return version(library)
    except PackageNotFoundError:
        return "not installed"


def blas_kernels() -> list[str]:
    """BLAS libraries of this process: version, kernel for this processor, and threads.

    OpenBLAS chooses the kernel by the processor's model or ``OPENBLAS_CORETYPE``; another one adds
    in another order.
    """
    return sorted(
        f"{one['internal_api']} {one['version']} {one.get('architecture', '')}, "
        f"threads {one['num_threads']}"
        for one in threadpool_info()
        if one["user_api"] == "blas"
    )


# -- entries ---------------------------------------------------------------------------------------


def _entry(directory: Path, key: str) -> Path:
    return directory / "entries" / key[:2] / key


def restore(directory: Path, key: str, outputs: Mapping[str, Path]) -> bool:
    """Copy the outputs of an entry into place if it is there and sound; remove it if it is damaged.

    Parameters
    ----------
    directory
        The cache's.
    key
        The entry's (`entry_key`).
    outputs
        Where its files go, by their names.

    Returns
    -------
    Whether they were there.
    """
    entry = _entry(directory, key)
    if not entry.exists():
        return False
    try:
        files = _files(entry)
        with ExitStack() as stack:
            # all are copied and verified before the first of them is renamed
            for name, path in outputs.items():
                partial = stack.enter_context(atomic(path))
                if _copy(entry / name, partial) != files.get(name):
                    raise DamagedEntryError(f"{name} is not what was stored")
    except DamagedEntryError as error:
        _discard(directory, entry, str(error))
        return False
    except OSError as error:
        logger.warning("the cache is not used: %s: %s", type(error).__name__, error)
        return False
    with suppress(OSError):  # another user's cache is read, too
        os.utime(entry / _RECORD)  # its last use
    logger.info("outputs taken from the cache: entry %s", key)
    return True


def store(
    directory: Path, key: str, rule: str, outputs: Mapping[str, Path], seconds: float
) -> None:
    """Copy a job's outputs into an entry, which appears whole or not at all.

    Parameters
    ----------
    directory
        The cache's; made if it is not there.
    key
        The entry's (`entry_key`).
    rule
        The job's, for those who look at the cache.
    outputs
        The job's files, by their names.
    seconds
        What they cost.
    """
    entry = _entry(directory, key)
    building = directory / "building" / f"{key}.{os.urandom(6).hex()}"
    try:
        if entry.exists():  # another run was faster
            return
        building.mkdir(parents=True)
        files = {name: _copy(path, building / name) for name, path in outputs.items()}
        for name, path in outputs.items():
            with (building / name).open("rb") as file:
                os.fsync(file.fileno())
            if digest(path) != files[name]:
                raise OSError(f"{path} changed while it was copied")
        record = {"rule": rule, "seconds": round(seconds, 3), "files": files}
        write_json(building / _RECORD, record)
        entry.parent.mkdir(parents=True, exist_ok=True)
        with suppress(FileExistsError):
            _rename(building, entry)
    except OSError as error:
        logger.warning("outputs are not cached: %s: %s", type(error).__name__, error)
        return
    finally:
        shutil.rmtree(building, ignore_errors=True)
    logger.info("outputs put into the cache: entry %s", key)


def _rename(building: Path, entry: Path) -> None:
    try:
        os.rename(building, entry)
    except OSError as error:
        if entry.exists():
            raise FileExistsError(entry) from error
        raise


def _files(entry: Path) -> dict[str, str]:
    """Digests of an entry's files, by name."""
    record = _read_record(entry)
    if not isinstance(files := record.get("files"), dict):
        raise DamagedEntryError("its record says nothing of files")
    return {str(name): str(value) for name, value in files.items()}


def _read_record(entry: Path) -> dict[str, Any]:
    try:
        record = json.loads((entry / _RECORD).read_bytes())
    except (OSError, ValueError, RecursionError) as error:
        raise DamagedEntryError(f"its record cannot be read ({type(error).__name__})") from error
    if not isinstance(record, dict):
        raise DamagedEntryError("its record is none")
    return record


def _copy(source: Path, target: Path) -> str:
    """Copy a file and return the digest of what was copied."""
    content = hashlib.sha256()
    try:
        read = source.open("rb")
    except (FileNotFoundError, IsADirectoryError) as error:  # pruned meanwhile, or damaged
        raise DamagedEntryError(f"{source.name} is missing") from error
    with read, target.open("xb") as written:
        while block := read.read(_BLOCK):
            content.update(block)
            written.write(block)
    return content.hexdigest()


def _discard(directory: Path, entry: Path, reason: str) -> None:
    logger.warning("cache entry %s is damaged and removed: %s", entry.name, reason)
    try:
        _remove(directory, entry)
    except OSError as error:
        logger.warning("it cannot be removed: %s: %s", type(error).__name__, error)


def _remove(directory: Path, entry: Path) -> None:
    """Remove an entry so that nobody finds half of it."""
    rubbish = directory / "building" / f"{entry.name}.{os.urandom(6).hex()}"
    rubbish.parent.mkdir(parents=True, exist_ok=True)
    try:
        os.rename(entry, rubbish)
    except FileNotFoundError:  # another run has removed it
        return
    _delete(rubbish)


def _delete(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


# -- its size, and pruning -------------------------------------------------------------------------


@dataclass(frozen=True)
class Entry:
    """An entry of the cache: where it is, whose result, its bytes, and when it was last used."""

    path: Path
    rule: str
    size: int
    last_use: float


def entries(directory: Path) -> Iterator[Entry]:
    """All entries, those that cannot be read included (their rule is ``damaged``)."""
    for path in sorted((directory / "entries").glob("??/*")):
        if not _KEY.fullmatch(path.name) or path.parent.name != path.name[:2]:
            continue
        with suppress(FileNotFoundError):  # pruned by somebody else meanwhile
            size = sum(file.stat().st_size for file in (path, *path.rglob("*")) if file.is_file())
            try:
                rule = str(_read_record(path).get("rule", "damaged"))
                last_use = (path / _RECORD).stat().st_mtime
            except DamagedEntryError:
                rule, last_use = "damaged", path.lstat().st_mtime
            yield Entry(path, rule, size, last_use)


def verify(directory: Path) -> list[Path]:
    """Remove all entries that are not what was stored, and return where they were."""
    damaged = []
    for entry in entries(directory):
        try:
            for name, content in _files(entry.path).items():
                if digest(entry.path / name) != content:
                    raise DamagedEntryError(f"{name} is not what was stored")
        except (OSError, DamagedEntryError) as error:
            if entry.path.exists():
                _discard(directory, entry.path, str(error))
                damaged.append(entry.path)
    return damaged


def prune(
    directory: Path, *, older_than: float | None = None, to_size: int | None = None
) -> list[Entry]:
    """Remove entries, those first that were not used for the longest time.

    Parameters
    ----------
    directory
        The cache's.
    older_than
        Remove what was not used for so many seconds.
    to_size
        Remove until at most so many bytes are left.

    Returns
    -------
    What was removed.
    """
    now = time.time()
    kept = sorted(entries(directory), key=lambda entry: entry.last_use)
    left = sum(entry.size for entry in kept)
    removed = []
    for entry in kept:
        old = older_than is not None and now - entry.last_use > older_than
        if old or (to_size is not None and left > to_size):
            _remove(directory, entry.path)
            removed.append(entry)
            left -= entry.size
    for path in (directory / "building").glob("*"):  # left by jobs that were killed
        with suppress(FileNotFoundError):
            old = now - path.stat().st_mtime > _ABANDONED_SECONDS  # no copy takes a day
            if old and _BUILDING.fullmatch(path.name):
                _delete(path)
    return removed
