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

On the command line::

    python -m burstcast_workflow.harness.cache size
    python -m burstcast_workflow.harness.cache verify
    python -m burstcast_workflow.harness.cache prune --older-than 30d
    python -m burstcast_workflow.harness.cache prune --to-size 20G
"""

import argparse
import hashlib
import json
import logging
import os
import platform
import re
import shutil
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from burstcast_workflow.canonical import canonical_json
from burstcast_workflow.harness.code_check import changed_code, script_of
from burstcast_workflow.harness.storage import atomic, write_json

logger = logging.getLogger(__name__)

VARIABLE = "BURSTCAST_CACHE"
"""Environment variable that names the cache's directory. It is no setting: it changes no result."""

LIBRARIES = ("numpy", "scipy", "numba", "scikit-learn", "scikit-optimize")
"""Libraries another version of which may give other numbers."""

_FORMAT = 3
_RECORD = "record.json"
_BLOCK = 2**20
# digests of larger files are remembered; reading a smaller one takes less time than that
_REMEMBERED_FROM = 4 * 2**20
# a file that changed so recently may change again without a trace in its time stamps
_SETTLED_SECONDS = 2.0
_ABANDONED_SECONDS = 24 * 3600.0


def location() -> Path | None:
    """Directory of the cache; None where there is none."""
    directory = os.environ.get(VARIABLE, "")
    return Path(directory).expanduser() if directory else None


@dataclass(frozen=True)
class CachedJob:
    """A job as the cache sees it.

    Attributes
    ----------
    rule
        Its rule.
    settings
        All settings that its script reads.
    script
        The file of its script.
    code
        Fingerprints of its code, as its rule passes them.
    inputs, outputs
        Its files, by name: one or several under each name of the inputs.
    identity
        Which job it is: outputs say it, so that those of another job are not its own.
    cached
        Whether its rule says that its results are worth keeping; most others take seconds.
    """

    rule: str
    settings: Mapping[str, Any]
    script: Path
    code: Sequence[str]
    inputs: Mapping[str, Sequence[Path]]
    outputs: Mapping[str, Path]
    identity: Mapping[str, Any]
    cached: bool = True


def cached_job(
    snakemake: Any, settings: Mapping[str, Any], identity: Mapping[str, Any]
) -> CachedJob:
    """Describe the job that a script runs in, from the object that Snakemake puts into it."""
    code = list(snakemake.params.code)
    return CachedJob(
        rule=snakemake.rule,
        settings=settings,
        script=script_of(snakemake),
        code=code,
        inputs={
            name: [Path(files)] if isinstance(files, str) else [Path(file) for file in files]
            for name, files in snakemake.input.items()
        },
        outputs={name: Path(file) for name, file in snakemake.output.items()},
        identity=identity,
        cached=bool(snakemake.resources.get("cached", 0)),
    )


def through_cache(directory: Path, job: CachedJob, compute: Callable[[], None]) -> bool:
    """Take a job's outputs from the cache, or compute them and put them into it.

    Parameters
    ----------
    directory
        The cache's.
    job
        The job; only those whose rule says that they are cached are looked up.
    compute
        Writes the job's outputs. Its exceptions are passed on.

    Returns
    -------
    Whether the outputs were taken from the cache.
    """
    if not job.cached:
        compute()
        return False
    try:
        inputs = _Inputs.read(directory, job)
        key = _key(job, inputs.digests)
        if _restore(directory, key, job):
            logger.info("outputs taken from the cache: entry %s", key)
            return True
        sound = not changed_code(job.script, job.code)
    except (OSError, ValueError, SyntaxError) as error:
        logger.warning("the cache is not used: %s: %s", type(error).__name__, error)
        compute()
        return False
    start = time.monotonic()
    compute()
    seconds = time.monotonic() - start
    try:
        # What was edited after Snakemake took the fingerprints, or while the job ran, may have
        # taken part in the outputs: they do not belong to this key.
        if not sound or changed_code(job.script, job.code) or not inputs.unchanged():
            logger.warning("outputs are not cached: code or inputs have changed meanwhile")
        else:
            _store(directory, key, job, seconds)
            logger.info("outputs put into the cache: entry %s", key)
    except (OSError, SyntaxError) as error:
        logger.warning("outputs are not cached: %s: %s", type(error).__name__, error)
    return False


# -- what an entry depends on ----------------------------------------------------------------------


def _key(job: CachedJob, input_digests: Mapping[str, Sequence[str]]) -> str:
    material = {
        "format": _FORMAT,
        "rule": job.rule,
        "identity": job.identity,
        "settings": job.settings,
        "code": sorted(job.code),
        "libraries": {name: _version(name) for name in LIBRARIES},
        "python": ".".join(platform.python_version_tuple()[:2]),
        "machine": platform.machine(),
        "inputs": input_digests,
        "outputs": sorted(job.outputs),
    }
    return hashlib.sha256(canonical_json(material, "key").encode()).hexdigest()


@cache
def _version(library: str) -> str:
    return version(library)


_Stamp = tuple[int, int, int, int, int]


@dataclass(frozen=True)
class _Inputs:
    """Contents of a job's inputs, and the state of the files that they were read from."""

    digests: Mapping[str, Sequence[str]]
    stamps: Mapping[Path, _Stamp]

    @classmethod
    def read(cls, directory: Path, job: CachedJob) -> "_Inputs":
        paths = [path for group in job.inputs.values() for path in group]
        stamps = {path: _stamp(path) for path in paths}
        digests = {
            name: [_remembered_digest(directory, path) for path in group]
            for name, group in job.inputs.items()
        }
        return cls(digests, stamps)

    def unchanged(self) -> bool:
        return all(_stamp(path) == stamp for path, stamp in self.stamps.items())


def _stamp(path: Path) -> _Stamp:
    """State of a file: a change of its content changes it, since nobody can set the ctime."""
    state = path.stat()
    return state.st_dev, state.st_ino, state.st_size, state.st_mtime_ns, state.st_ctime_ns


def _digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _remembered_digest(directory: Path, path: Path) -> str:
    """Digest of a file, remembered beside the entries for as long as the file stays as it is.

    An ensemble of hundreds of megabytes is an input of hundreds of jobs.
    """
    stamp = _stamp(path)
    if stamp[2] < _REMEMBERED_FROM:
        return _digest(path)
    name = hashlib.sha256(os.fsencode(path.resolve())).hexdigest()
    memory = directory / "digests" / f"{name}.json"
    try:
        record = json.loads(memory.read_bytes())
        if record["stamp"] == list(stamp):
            return str(record["digest"])
    except (OSError, ValueError, KeyError, TypeError):
        pass  # unknown, or half-written by someone without atomic renames: read the file
    digest = _digest(path)
    if _stamp(path) == stamp and time.time() - stamp[4] / 1e9 > _SETTLED_SECONDS:
        memory.parent.mkdir(parents=True, exist_ok=True)
        write_json(memory, {"stamp": list(stamp), "digest": digest})
    return digest


# -- entries ---------------------------------------------------------------------------------------


def _entry(directory: Path, key: str) -> Path:
    return directory / "entries" / key[:2] / key


def _restore(directory: Path, key: str, job: CachedJob) -> bool:
    """Copy the outputs of an entry into place if it is there and sound; remove it if it is not."""
    entry = _entry(directory, key)
    try:
        files = _files(entry)
    except FileNotFoundError:
        return False
    except ValueError as error:
        _discard(directory, entry, str(error))
        return False
    try:
        with ExitStack() as stack:
            # all are copied and verified before the first of them is renamed
            for name, path in job.outputs.items():
                path.parent.mkdir(parents=True, exist_ok=True)
                partial = stack.enter_context(atomic(path))
                if _copy(entry / name, partial) != files.get(name):
                    raise ValueError(f"{name} is not what was stored")
    except FileNotFoundError as error:  # an entry that is being pruned, or has lost a file
        _discard(directory, entry, f"{Path(error.filename or '').name} is missing")
        return False
    except ValueError as error:
        _discard(directory, entry, str(error))
        return False
    os.utime(entry / _RECORD)  # its last use
    return True


def _files(entry: Path) -> dict[str, str]:
    """Digests of an entry's files, by name.

    Raises
    ------
    FileNotFoundError
        If there is no entry.
    ValueError
        If its record cannot be read.
    """
    if not entry.is_dir():
        raise FileNotFoundError(entry)
    try:
        record = json.loads((entry / _RECORD).read_bytes())
        return {str(name): str(digest) for name, digest in record["files"].items()}
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"its record cannot be read ({type(error).__name__})") from error


def _copy(source: Path, target: Path) -> str:
    """Copy a file and return the digest of what was copied."""
    digest = hashlib.sha256()
    with source.open("rb") as read, target.open("xb") as written:
        while block := read.read(_BLOCK):
            digest.update(block)
            written.write(block)
    return digest.hexdigest()


def _store(directory: Path, key: str, job: CachedJob, seconds: float) -> None:
    """Copy a job's outputs into an entry, which appears whole or not at all."""
    entry = _entry(directory, key)
    if entry.exists():  # another run was faster
        return
    building = directory / "building" / f"{key}.{os.urandom(6).hex()}"
    building.mkdir(parents=True)
    try:
        files = {name: _copy(path, building / name) for name, path in job.outputs.items()}
        for name, path in job.outputs.items():
            _flush(building / name)
            if _digest(path) != files[name]:
                raise OSError(f"{path} changed while it was copied")
        write_json(
            building / _RECORD, {"rule": job.rule, "seconds": round(seconds, 3), "files": files}
        )
        entry.parent.mkdir(parents=True, exist_ok=True)
        try:
            os.rename(building, entry)
        except OSError:
            if not entry.exists():
                raise
    finally:
        shutil.rmtree(building, ignore_errors=True)


def _flush(path: Path) -> None:
    with path.open("rb") as file:
        os.fsync(file.fileno())


def _discard(directory: Path, entry: Path, reason: str) -> None:
    logger.warning("cache entry %s is damaged and removed: %s", entry.name, reason)
    _remove(directory, entry)


def _remove(directory: Path, entry: Path) -> None:
    """Remove an entry so that nobody finds half of it."""
    rubbish = directory / "building" / f"{entry.name}.{os.urandom(6).hex()}"
    rubbish.parent.mkdir(parents=True, exist_ok=True)
    try:
        os.rename(entry, rubbish)
    except FileNotFoundError:  # another run has removed it
        return
    shutil.rmtree(rubbish, ignore_errors=True)


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
        try:
            size = sum(file.stat().st_size for file in path.iterdir())
            try:
                rule = str(json.loads((path / _RECORD).read_bytes())["rule"])
                last_use = (path / _RECORD).stat().st_mtime
            except (FileNotFoundError, ValueError, KeyError, TypeError):
                rule, last_use = "damaged", path.stat().st_mtime
        except FileNotFoundError:  # pruned by somebody else meanwhile
            continue
        yield Entry(path, rule, size, last_use)


def verify(directory: Path) -> list[Path]:
    """Remove all entries that are not what was stored, and return where they were."""
    damaged = []
    for entry in entries(directory):
        try:
            sound = all(
                _digest(entry.path / name) == digest for name, digest in _files(entry.path).items()
            )
        except (FileNotFoundError, ValueError):
            sound = False
        if not sound and entry.path.exists():
            _discard(directory, entry.path, "found by verify")
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
    _remove_abandoned(directory, now)
    return removed


def _remove_abandoned(directory: Path, now: float) -> None:
    """Remove what jobs that were killed have left: no copy takes a day."""
    for path in [*(directory / "building").glob("*"), *(directory / "digests").glob("*")]:
        try:
            if now - path.stat().st_mtime > _ABANDONED_SECONDS:
                shutil.rmtree(path) if path.is_dir() else path.unlink()
        except FileNotFoundError:
            continue


# -- command line ----------------------------------------------------------------------------------

_SECONDS = {"s": 1, "min": 60, "h": 3600, "d": 86400, "w": 7 * 86400}
_BYTES = {"": 1, "K": 2**10, "M": 2**20, "G": 2**30, "T": 2**40}


def _quantity(text: str, units: Mapping[str, int]) -> float:
    match = re.fullmatch(r"(\d+(?:\.\d+)?)\s*([A-Za-z]*)", text)
    if match is None or match[2] not in units:
        names = ", ".join(name for name in units if name)
        raise argparse.ArgumentTypeError(f"{text!r}: a number and one of {names}")
    return float(match[1]) * units[match[2]]


def _age(text: str) -> float:
    return _quantity(text, _SECONDS)


def _size(text: str) -> int:
    return int(_quantity(text, _BYTES))


def readable_size(size: float) -> str:
    """Size in bytes as a person reads it: 1.5 GiB."""
    for unit in ("B", "KiB", "MiB", "GiB"):
        if size < 1024:
            return f"{size:.0f} {unit}" if unit == "B" else f"{size:.1f} {unit}"
        size /= 1024
    return f"{size:.1f} TiB"


def main(arguments: Sequence[str] | None = None) -> int:
    """Show the size of the cache, verify or prune it."""
    parser = argparse.ArgumentParser(
        prog="python -m burstcast_workflow.harness.cache",
        description="Results shared between campaigns: their size, verification and pruning.",
    )
    parser.add_argument(
        "--cache", type=Path, default=location(), help=f"its directory (default: ${VARIABLE})"
    )
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("size", help="entries and bytes of each rule")
    commands.add_parser("verify", help="read all entries, remove damaged ones")
    pruning = commands.add_parser("prune", help="remove entries, least recently used first")
    pruning.add_argument("--older-than", type=_age, help="unused for: 12h, 30d, 4w")
    pruning.add_argument("--to-size", type=_size, help="until at most: 500M, 20G")
    chosen = parser.parse_args(arguments)
    if chosen.cache is None:
        parser.error(f"which cache? Set {VARIABLE} or give --cache")
    if not chosen.cache.is_dir():
        print(f"{chosen.cache} does not exist: the cache is empty")
        return 0
    if chosen.command == "size":
        _print_sizes(list(entries(chosen.cache)))
        return 0
    if chosen.command == "verify":
        damaged = verify(chosen.cache)
        for path in damaged:
            print(f"damaged, removed: {path}")
        print(f"{sum(1 for _ in entries(chosen.cache))} entries are sound")
        return 1 if damaged else 0
    if chosen.older_than is None and chosen.to_size is None:
        parser.error("prune needs --older-than or --to-size")
    removed = prune(chosen.cache, older_than=chosen.older_than, to_size=chosen.to_size)
    print(f"removed {len(removed)} entries, {readable_size(sum(entry.size for entry in removed))}")
    return 0


def _print_sizes(found: Sequence[Entry]) -> None:
    for rule in sorted({entry.rule for entry in found}):
        sizes = [entry.size for entry in found if entry.rule == rule]
        print(f"{rule:20} {len(sizes):6} {readable_size(sum(sizes)):>12}")
    print(f"{'all':20} {len(found):6} {readable_size(sum(entry.size for entry in found)):>12}")


if __name__ == "__main__":
    sys.exit(main())
