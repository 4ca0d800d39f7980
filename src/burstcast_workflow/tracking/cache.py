"""The cache of actions: what earlier jobs made, by everything that it depends on.

The key of a job is a hash of its script, wildcards, settings, code, contents of the inputs, and
versions of what computes: it has no path of the results, so that campaigns and clones share. An
entry is a directory with the outputs, which are links to the results where the file system allows
it, the log, and ``entry.json`` with digests and seconds. Trouble with the cache is logged, and the
job computes.
"""

import hashlib
import json
import logging
import os
import re
import secrets
import shutil
import statistics
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from burstcast.base.files.atomic_files import PARTIAL_SUFFIX
from burstcast_workflow.tracking.results import digest

logger = logging.getLogger(__name__)

VARIABLE = "BURSTCAST_CACHE"
"""Environment variable: the directory of the cache; empty: no cache. It is no setting, since it
changes no result."""

_DEFAULT = ".burstcast_cache"
_RECORD = "entry.json"
_LOG = "log"
_FORMAT = 1
_DAY = 86400.0


def directory() -> Path | None:
    """Directory of the cache, beside ``.snakemake`` by default; None if it is switched off."""
    cache = os.environ.get(VARIABLE, _DEFAULT)
    return Path(cache).expanduser().absolute() if cache else None


class Entry:
    """The outputs of a job in the cache. ``depends_on``: All that they depend on, as plain data."""

    def __init__(self, outputs: Sequence[str], /, **depends_on: Any) -> None:
        text = json.dumps({"format": _FORMAT, **depends_on}, sort_keys=True)
        key = hashlib.sha256(text.encode()).hexdigest()
        cache = directory()
        self._place = cache / key[:2] / key if cache else None
        self._outputs = outputs

    def restore(self) -> tuple[float, str] | None:
        """Put the outputs in place, if they are undamaged; the seconds and the log of their job."""
        if self._place is None or not self._place.exists():
            return None
        partials = [
            str(path.with_name(f".{path.name}.{secrets.token_hex(4)}{PARTIAL_SUFFIX}"))
            for path in map(Path, self._outputs)
        ]
        try:
            record = json.loads((self._place / _RECORD).read_bytes())
            seconds, log = float(record["seconds"]), (self._place / _LOG).read_text("utf-8")
            digests: list[str] = record["digests"]
            for number, (partial, content) in enumerate(zip(partials, digests, strict=True)):
                _take(self._place / str(number), partial)
                if digest(partial) != content:
                    raise ValueError(f"file {number} is not what was stored")
            for path, partial in zip(self._outputs, partials, strict=True):
                os.replace(partial, path)
        except (ValueError, KeyError, TypeError, FileNotFoundError) as error:
            logger.warning("entry %s of the cache is damaged: %s", self._place, error)
            _remove(self._place)
            return None
        except OSError as error:
            logger.warning("nothing is taken from the cache: %s", error)
            return None
        finally:
            for partial in partials:
                Path(partial).unlink(missing_ok=True)
        with suppress(OSError):  # another user's cache
            os.utime(self._place / _RECORD)  # its last use
        return seconds, log

    def store(self, digests: Sequence[str], rule: str, seconds: float, log: Path) -> None:
        """Keep the outputs, with their digests, and what their job was."""
        if self._place is None:
            return
        partial = self._place.with_name(f"{self._place.name}.{secrets.token_hex(4)}")
        try:
            partial.mkdir(parents=True)
            for number, path in enumerate(self._outputs):
                _link_or_copy(path, partial / str(number))
            shutil.copyfile(log, partial / _LOG)
            record = {"rule": rule, "seconds": seconds, "digests": [*digests]}
            (partial / _RECORD).write_text(json.dumps(record))
            partial.rename(self._place)
        except OSError as error:
            if not self._place.exists():  # else another job was as fast
                logger.warning("nothing is put into the cache: %s", error)
        finally:
            shutil.rmtree(partial, ignore_errors=True)


def _take(blob: Path, path: str) -> None:
    """Link to a file of the cache, or copy it where another result is a link to it.

    Links share their time, on which Snakemake acts: that of one campaign must not change with
    another one.
    """
    if blob.stat().st_nlink == 1:
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
    """Remove an entry: half of it is never found."""
    rubbish = entry.with_name(f"{entry.name}.{secrets.token_hex(4)}")
    with suppress(OSError):
        entry.rename(rubbish)
    shutil.rmtree(rubbish, ignore_errors=True)


# -- the whole cache -------------------------------------------------------------------------------


def _entries(cache: Path) -> Iterator[tuple[Path, float]]:
    """Entries, and what others have left half-made, each with the time of its last use."""
    for place in cache.glob("[0-9a-f][0-9a-f]/*"):
        if re.fullmatch(r"[0-9a-f]{64}(\.[0-9a-f]{8})?", place.name):
            record = place / _RECORD
            with suppress(OSError):
                yield place, (record if record.exists() else place).stat().st_mtime


def _size(entry: Path) -> int:
    """Bytes of the outputs in an entry: none for what present results link to."""
    states = [path.stat() for path in entry.iterdir() if path.name.isdigit()]
    return sum(state.st_size for state in states if state.st_nlink == 1)


def tidy(most_bytes: float) -> None:
    """Remove the entries that were unused for longest until the cache has a size, and leftovers."""
    cache = directory()
    if cache is None:
        return
    total, now = 0, time.time()
    for place, used in sorted(_entries(cache), key=lambda pair: -pair[1]):
        half_made = "." in place.name
        with suppress(OSError):
            size = 0 if half_made else _size(place)
            total += size
            if (half_made and now - used > _DAY) or (size and total > most_bytes):
                total -= size
                _remove(place)


def seconds_of_rules() -> Mapping[str, float]:
    """Seconds that jobs of each rule took to compute, in the median over the cache."""
    cache = directory()
    seconds_by_rule: dict[str, list[float]] = {}
    for place, _ in _entries(cache) if cache else ():
        with suppress(OSError, ValueError, KeyError, TypeError):
            record = json.loads((place / _RECORD).read_bytes())
            seconds_by_rule.setdefault(str(record["rule"]), []).append(float(record["seconds"]))
    return {rule: statistics.median(seconds) for rule, seconds in seconds_by_rule.items()}
