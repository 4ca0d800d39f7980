"""Results shared between campaigns, result directories and working copies.

An entry of the cache holds the outputs of one job under a key made of everything that they depend
on: rule, settings, fingerprints of the code, the content of the inputs, and the environment. A job
whose key is there takes its outputs from the cache instead of computing them.

Entries are written under a temporary name and renamed, and every file is verified by its checksum
each time it is used. Trouble with the cache itself is logged and otherwise ignored: the job then
computes. Outputs are copied, not linked: a link would share its time stamp, which Snakemake acts
on, with other campaigns.
"""

import hashlib
import json
import logging
import os
import shutil
from collections.abc import Mapping
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from snaketrust.files import digest, flush, replaced
from snaketrust.run import check_ownership

logger = logging.getLogger(__name__)

_FORMAT = 6
_RECORD = "record.json"
_BLOCK = 2**20


class DamagedEntryError(ValueError):
    """An entry is not what was stored."""


@dataclass(frozen=True)
class Cache:
    """A directory of entries."""

    directory: Path  #: it is made when the first entry is stored
    #: what results depend on beside settings, code and inputs, such as versions of libraries
    environment: Mapping[str, Any]

    def entry(self, **job: Any) -> Path:
        """Directory of the entry of a job, by a hash of everything that its outputs depend on.

        ``job`` is plain data: rule, wildcards, settings, code, digests of inputs, names of files.
        """
        material = {"format": _FORMAT, "environment": self.environment, **job}
        key = hashlib.sha256(json.dumps(material, sort_keys=True).encode()).hexdigest()
        return self.directory / "entries" / key[:2] / key


def restore(entry: Path, outputs: Mapping[str, Path]) -> bool:
    """Copy the outputs of an entry into place and return True; remove a damaged entry."""
    if not entry.exists():
        return False
    try:
        files = _files(entry)
        with ExitStack() as stack:
            # all are copied and verified before the first of them is renamed
            for name, path in outputs.items():
                partial = stack.enter_context(replaced(path, check_ownership))
                if _copy(entry / name, partial) != files.get(name):
                    raise DamagedEntryError(f"{name} is not what was stored")
                flush(partial)
    except DamagedEntryError as error:
        _discard(entry, str(error))
        return False
    except OSError as error:
        logger.warning("the cache is not used: %s: %s", type(error).__name__, error)
        return False
    with suppress(OSError):  # another user's cache is read, too
        os.utime(entry)  # its last use
    logger.info("outputs taken from the cache: entry %s", entry.name)
    return True


def store(entry: Path, rule: str, outputs: Mapping[str, Path], seconds: float) -> None:
    """Copy a job's outputs into an entry, which appears whole or not at all.

    Rule and seconds are for readers of the cache.
    """
    building = _building(entry)
    try:
        if entry.exists():  # another run was faster
            return
        building.mkdir(parents=True)
        files = {name: _copy(path, building / name) for name, path in outputs.items()}
        for name, path in outputs.items():
            flush(building / name)
            if digest(path) != files[name]:
                raise OSError(f"{path} changed while it was copied")
        record = {"rule": rule, "seconds": round(seconds, 3), "files": files}
        (building / _RECORD).write_text(json.dumps(record))
        flush(building / _RECORD)
        entry.parent.mkdir(parents=True, exist_ok=True)
        try:
            os.rename(building, entry)
        except OSError:
            if not entry.exists():  # nor was another run faster meanwhile
                raise
    except OSError as error:
        logger.warning("outputs are not cached: %s: %s", type(error).__name__, error)
        return
    finally:
        shutil.rmtree(building, ignore_errors=True)
    logger.info("outputs put into the cache: entry %s", entry.name)


def _building(entry: Path) -> Path:
    """Place where an entry is built or removed: on the same file system, under another name."""
    return entry.parents[2] / "building" / f"{entry.name}.{os.urandom(6).hex()}"


def _files(entry: Path) -> dict[str, str]:
    """Digests of an entry's files, by name."""
    try:
        return dict(json.loads((entry / _RECORD).read_bytes())["files"])
    except (OSError, ValueError, RecursionError, TypeError, KeyError) as error:
        raise DamagedEntryError(f"its record cannot be read ({type(error).__name__})") from error


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


def _discard(entry: Path, reason: str) -> None:
    """Remove an entry atomically: no reader finds half of it."""
    logger.warning("cache entry %s is damaged and removed: %s", entry.name, reason)
    rubbish = _building(entry)
    try:
        rubbish.parent.mkdir(parents=True, exist_ok=True)
        with suppress(FileNotFoundError):  # another run has removed it
            os.rename(entry, rubbish)
    except OSError as error:
        logger.warning("it cannot be removed: %s: %s", type(error).__name__, error)
    if rubbish.is_dir() and not rubbish.is_symlink():
        shutil.rmtree(rubbish, ignore_errors=True)
    else:
        rubbish.unlink(missing_ok=True)
