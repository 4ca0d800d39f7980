"""The cache of actions: what earlier jobs made, by everything that it depends on.

The key of a job is a hash of its script, wildcards, settings, code, contents of the inputs, and
versions of what computes: it has no path of the results, so that campaigns and clones share. An
entry is a directory with the outputs, which are links to the results where the file system allows
it, the log, and ``entry.json`` with digests and seconds. Trouble with the cache is logged, and the
job computes; the terminal says, once for each run, that a place cannot be a cache.
"""

import hashlib
import json
import logging
import math
import os
import re
import secrets
import shutil
import stat
import statistics
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from burstcast.base.files.atomic_files import PARTIAL_SUFFIX
from burstcast_workflow.tracking.results import digest
from burstcast_workflow.tracking.run import check_ownership

logger = logging.getLogger(__name__)

VARIABLE = "BURSTCAST_CACHE"
"""Environment variable: the directory of the cache; empty: no cache. It is no setting, since it
changes no result."""

REFRESH = "BURSTCAST_CACHE_REFRESH"
"""Environment variable: unless it is empty or 0, jobs compute, and their outputs replace the
entries of their keys. For what no key knows, such as a file that a module reads unknown to its
case."""

_DEFAULT = ".burstcast_cache"
_RECORD = "entry.json"
_LOG = "log"
_FORMAT = 1
_DAY = 86400.0


def directory() -> Path | None:
    """Directory of the cache, beside ``.snakemake`` by default; None if it is switched off.

    None, too, below the home directory of an unknown user (`trouble`).
    """
    with suppress(RuntimeError):
        place = os.environ.get(VARIABLE, _DEFAULT)
        return Path(place).expanduser().absolute() if place else None
    return None


def refreshes() -> bool:
    """Whether jobs compute whatever the cache has, and replace it."""
    return os.environ.get(REFRESH, "") not in ("", "0")


def trouble() -> str | None:
    """What is wrong with the place of the cache, in one sentence; None if nothing is."""
    place = os.environ.get(VARIABLE, _DEFAULT)
    if not place:
        return None
    if (root := directory()) is None:
        return f"there is no cache: {VARIABLE} is {place}, and no home directory is known for that"
    probe = root / f".{secrets.token_hex(8)}"
    try:
        probe.mkdir(parents=True)
        probe.rmdir()
    except OSError as error:
        reason = f"{root} ({error.strerror})"
        if os.path.isdir(root) and os.access(root, os.R_OK | os.X_OK):
            return f"nothing is put into the cache, which cannot be written: {reason}"
        return f"there is no cache, since its directory ({VARIABLE}) cannot be used: {reason}"
    return None


class _Record(NamedTuple):
    """What an entry says of itself."""

    rule: str
    seconds: float
    digests: list[str]

    @classmethod
    def of(cls, entry: Path) -> "_Record":
        """Read the record of an entry; `ValueError` if it is damaged."""
        content = (entry / _RECORD).read_bytes()
        try:
            record = json.loads(content)
            seconds = float(record["seconds"])
            made = cls(str(record["rule"]), seconds, [*map(str, record["digests"])])
        except (ValueError, LookupError, TypeError, OverflowError, RecursionError) as error:
            raise ValueError(f"{_RECORD}: {type(error).__name__}") from error
        if not 0 <= seconds < math.inf:
            raise ValueError(f"{_RECORD}: {seconds} seconds")
        return made


class Entry:
    """The outputs of a job in the cache. ``depends_on``: All that they depend on, as plain data."""

    def __init__(self, outputs: Sequence[str], /, **depends_on: Any) -> None:
        text = json.dumps({"format": _FORMAT, **depends_on}, sort_keys=True)
        key = hashlib.sha256(text.encode()).hexdigest()
        root = directory()
        self._place = root / key[:2] / key if root else None
        self._outputs = outputs

    def restore(self) -> tuple[float, str] | None:
        """Put the outputs in place, if they are undamaged; the seconds and the log of their job."""
        if self._place is None:
            return None
        if refreshes():
            _remove(self._place)
            return None
        partials = [
            str(path.with_name(f".{path.name}.{secrets.token_hex(4)}{PARTIAL_SUFFIX}"))
            for path in map(Path, self._outputs)
        ]
        try:
            if not self._place.exists():
                return None
            record, log = _Record.of(self._place), (self._place / _LOG).read_text("utf-8")
            for number, (partial, content) in enumerate(zip(partials, record.digests, strict=True)):
                _take(self._place / str(number), partial)
                if digest(partial) != content:
                    raise ValueError(f"file {number} is not what was stored")
            check_ownership()
            for path, partial in zip(self._outputs, partials, strict=True):
                os.replace(partial, path)
        except _DAMAGE as error:
            logger.warning("entry %s of the cache is damaged: %s", self._place, error)
            _remove(self._place)
            return None
        except OSError as error:
            logger.warning("nothing is taken from the cache: %s", error)
            return None
        finally:
            for partial in partials:
                with suppress(OSError):
                    Path(partial).unlink()
        with suppress(OSError):  # another user's cache
            os.utime(self._place / _RECORD)  # its last use
        return record.seconds, log

    def store(self, digests: Sequence[str], rule: str, seconds: float, log: Path) -> None:
        """Keep the outputs, with their digests, and what their job was."""
        if self._place is None:
            return
        partial = self._place.with_name(f"{self._place.name}.{secrets.token_hex(4)}")
        try:
            _make_shared(self._place.parent)
            partial.mkdir()
            for number, path in enumerate(self._outputs):
                _link_or_copy(path, partial / str(number))
            shutil.copyfile(log, partial / _LOG)
            (partial / _RECORD).write_text(json.dumps(_Record(rule, seconds, [*digests])._asdict()))
            partial.rename(self._place)
        except OSError as error:
            # else another job was as fast, or its entry could not be removed
            if refreshes() or not os.path.exists(self._place):
                logger.warning("nothing is put into the cache: %s", error)
        finally:
            shutil.rmtree(partial, ignore_errors=True)


_DAMAGE = ValueError, FileNotFoundError, NotADirectoryError, IsADirectoryError


def _make_shared(prefix: Path) -> None:
    """Make a directory of entries, as open as the cache is: its maker's umask does not count."""
    prefix.parent.mkdir(parents=True, exist_ok=True)
    with suppress(FileExistsError):
        prefix.mkdir()
        with suppress(OSError):
            prefix.chmod(prefix.parent.stat().st_mode & 0o7777)


def _take(blob: Path, path: str) -> None:
    """Link to a file of the cache, or copy it where another result is a link to it.

    Links share their time, on which Snakemake acts: that of one campaign must not change with
    another one.
    """
    state = blob.stat()
    if not stat.S_ISREG(state.st_mode):
        raise ValueError(f"{blob.name} is no file")
    if state.st_nlink == 1:
        with suppress(OSError):  # another file system, or another user's file
            os.link(blob, path)
            os.utime(path)
            return
        Path(path).unlink(missing_ok=True)
    shutil.copyfile(blob, path)


def _link_or_copy(source: str, target: Path) -> None:
    try:
        os.link(source, target)
    except OSError:
        shutil.copyfile(source, target)


def _remove(entry: Path) -> None:
    """Remove an entry, or a file in its place: half of it is never found."""
    rubbish = entry.with_name(f"{entry.name}.{secrets.token_hex(4)}")
    with suppress(OSError):
        entry.rename(rubbish)
        if not rubbish.is_dir():
            rubbish.unlink()
    shutil.rmtree(rubbish, ignore_errors=True)


# -- the whole cache -------------------------------------------------------------------------------


def _entries(root: Path) -> Iterator[tuple[Path, float]]:
    """Entries, and what others have left half-made, each with the time of its last use."""
    for prefix in _inside(root, r"[0-9a-f]{2}"):
        for place in _inside(prefix, r"[0-9a-f]{64}(\.[0-9a-f]{8})?"):
            record = place / _RECORD
            with suppress(OSError):
                yield place, (record if record.exists() else place).stat().st_mtime


def _inside(place: Path, pattern: str) -> list[Path]:
    """Paths in a directory with names of a pattern; none where it cannot be read."""
    with suppress(OSError):
        return [place / name for name in os.listdir(place) if re.fullmatch(pattern, name)]
    return []


def _size(entry: Path) -> int:
    """Bytes of the outputs in an entry: none for what present results link to."""
    states = [path.stat() for path in entry.iterdir() if path.name.isdigit()]
    return sum(state.st_size for state in states if state.st_nlink == 1)


def tidy(most_bytes: float) -> None:
    """Remove the entries that were unused for longest until the cache has a size, and leftovers."""
    _tell(trouble())
    root = directory()
    if root is None:
        return
    total, now = 0, time.time()
    for place, used in sorted(_entries(root), key=lambda pair: -pair[1]):
        half_made = "." in place.name
        with suppress(OSError):
            size = 0 if half_made else _size(place)
            total += size
            if (half_made and now - used > _DAY) or (size and total > most_bytes):
                total -= size
                _remove(place)


@cache
def _tell(text: str | None) -> None:
    """Print a text on the terminal, at the first time."""
    if text:
        print(text, file=sys.stderr)


def seconds_of_rules() -> Mapping[str, float]:
    """Seconds that jobs of each rule took to compute, in the median over the cache."""
    root = directory()
    seconds_by_rule: dict[str, list[float]] = {}
    for place, _ in _entries(root) if root else ():
        with suppress(OSError, ValueError):
            record = _Record.of(place)
            seconds_by_rule.setdefault(record.rule, []).append(record.seconds)
    return {rule: statistics.median(seconds) for rule, seconds in seconds_by_rule.items()}
